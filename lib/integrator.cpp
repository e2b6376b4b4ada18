#include "tact/lib/integrator.hpp"

#include <algorithm>
#include <cmath>

namespace tact {

TimeGrid TimeGrid::until(double t_end, double dt) {
    if (!(dt > 0) || !std::isfinite(dt)) throw InputError("TimeGrid: dt is " + std::to_string(dt) + ", expected > 0");
    const double steps = t_end / dt;
    if (!(steps >= 0) || std::abs(steps - std::round(steps)) > 1e-6)
        throw InputError("TimeGrid: t_end is " + std::to_string(t_end) +
                         ", expected a whole number of steps of dt = " + std::to_string(dt));
    return {dt, std::lround(steps), 0};
}

namespace {

void raise_to(KktResiduals& worst, const KktResiduals& kkt) {
    const auto worse = [](double a, double b) { return std::isnan(b) ? infinity : std::max(a, b); };
    worst.stationarity = worse(worst.stationarity, kkt.stationarity);
    worst.penetration = worse(worst.penetration, kkt.penetration);
    worst.negativity = worse(worst.negativity, kkt.negativity);
    worst.complementarity = worse(worst.complementarity, kkt.complementarity);
}

bool tell(std::span<const Observer> observers, const State& state, const StepReport& report) {
    bool proceed = true;
    for (const Observer& observer : observers) proceed &= observer(state, report) == Flow::proceed;
    return proceed;
}

}  // namespace

MarchReport integrate(const Integrator& method, const ContactProblem& problem, const TimeGrid& grid,
                      ContactWorkspace& workspace, std::span<const Observer> observers) {
    validate(problem);
    if (!(grid.dt > 0) || !std::isfinite(grid.dt))
        throw InputError("TimeGrid: dt is " + std::to_string(grid.dt) + ", expected > 0");
    if (grid.steps < 0) throw InputError("TimeGrid: steps is " + std::to_string(grid.steps) + ", expected >= 0");
    const auto run = method.start(problem, grid, workspace);
    MarchReport march;
    bool proceed = tell(observers, run->state(), march.last);
    while (proceed && march.accepted_steps < grid.steps) {
        march.last = run->advance();
        if (march.last.outcome != Outcome::converged) {
            march.outcome = march.last.outcome;
            break;
        }
        ++march.accepted_steps;
        const ContactReport& contact = march.last.contact;
        if (contact.active > 0 && march.first_contact_step == 0) march.first_contact_step = march.last.step;
        march.most_active = std::max(march.most_active, contact.active);
        march.contact_iterations += contact.iterations;
        raise_to(march.worst_kkt, contact.kkt);
        proceed = tell(observers, run->state(), march.last);
    }
    if (!proceed) march.outcome = Outcome::stopped;
    march.final_state = run->state();
    return march;
}

}  // namespace tact
