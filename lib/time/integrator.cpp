#include "integrator.hpp"

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

bool tell(std::span<const Observer> observers, const State& state, const StepReport& report) {
    bool proceed = true;
    for (const Observer& observer : observers) proceed &= observer(state, report) == Flow::proceed;
    return proceed;
}

void check(const TimeGrid& grid) {
    if (!(grid.dt > 0) || !std::isfinite(grid.dt))
        throw InputError("TimeGrid: dt is " + std::to_string(grid.dt) + ", expected > 0");
    if (grid.steps < 0) throw InputError("TimeGrid: steps is " + std::to_string(grid.steps) + ", expected >= 0");
}

/// The row of the largest violation of u0 in units of the row's own size, and that violation.
std::pair<Index, double> initial_violation(const ContactProblem& problem, const Vector& c) {
    const Vector gap = problem.B * problem.u0 - c;
    std::pair<Index, double> worst{0, 0};
    const double size = problem.u0.lpNorm<Eigen::Infinity>();
    for (Index i = 0; i < gap.size(); ++i) {
        if (c[i] == -infinity) continue;
        const double violation = -gap[i] / std::max({std::abs(c[i]), std::abs(gap[i] + c[i]), size, 1e-300});
        if (violation > worst.second) worst = {i, violation};
    }
    return worst;
}

/// The problem itself, or one with an admissible u0. Lives no longer than the one given.
Shared<ContactProblem> admissible(const ContactProblem& problem, double t0, const ContactWorkspace& workspace,
                                  const MarchOptions& options) {
    constexpr double rounding = 1e-9;
    if (problem.constraints() == 0 || problem.u0.size() == 0 ||
        options.initial_penetration == InitialPenetration::accept)
        return Shared<ContactProblem>::borrowed(problem);
    const Vector c = problem.c.at(t0);
    const auto [row, violation] = initial_violation(problem, c);
    if (violation <= rounding) return Shared<ContactProblem>::borrowed(problem);
    if (options.initial_penetration == InitialPenetration::reject)
        throw InputError("ContactProblem: u0 penetrates row " + std::to_string(row) + " by " +
                         std::to_string(100 * violation) +
                         " % of its size, expected B u0 >= c(t0); see InitialPenetration");
    const Combination metric = problem.M ? Combination{1, 0, 0} : problem.D ? Combination{0, 1, 0} : Combination{};
    ContactProblem repaired = problem;
    Vector lambda = Vector::Zero(problem.constraints());
    const Vector b = combined(problem, metric) * problem.u0;
    const ContactReport report = workspace.prepared(problem, metric)->solve(b, c, {repaired.u0, lambda});
    if (report.outcome != Outcome::converged)
        throw InputError("ContactProblem: u0 penetrates row " + std::to_string(row) +
                         " and cannot be projected: " + std::string(to_string(report.outcome)));
    return repaired;
}

using Step = std::function<Flow(const Run&, const StepReport&)>;

/// The one loop: `step` is called with the initial state and after every accepted step.
MarchReport march_through(const Integrator& method, const ContactProblem& given, const TimeGrid& grid,
                          const ContactWorkspace& workspace, const MarchOptions& options, const Step& step) {
    validate(given);
    check(grid);
    // The run ends here, before the problem given does: no copy is needed.
    const auto run = method.start(admissible(given, grid.t0, workspace, options), grid, workspace);
    MarchReport march;
    march.warning = run->warning();
    const double end = grid.t(grid.steps);
    bool proceed = step(*run, march.last) == Flow::proceed;
    while (proceed && run->state().t < end) {
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
        march.worst_kkt.raise_to(contact.kkt);
        if (march.last.impact) march.worst_kkt.raise_to(march.last.impact->kkt);
        proceed = step(*run, march.last) == Flow::proceed;
    }
    if (!proceed) march.outcome = Outcome::stopped;
    march.counters = run->counters();
    march.final_state = run->state();
    return march;
}

}  // namespace

void Run::dense(double, State&) const { throw InputError("Run: this integrator has no dense output"); }

MarchReport integrate(const Integrator& method, const ContactProblem& problem, const TimeGrid& grid,
                      const ContactWorkspace& workspace, std::span<const Observer> observers,
                      const MarchOptions& options) {
    return march_through(method, problem, grid, workspace, options, [&](const Run& run, const StepReport& report) {
        return tell(observers, run.state(), report) ? Flow::proceed : Flow::stop;
    });
}

MarchReport integrate_with_output(const Integrator& method, const ContactProblem& problem, const TimeGrid& grid,
                                  const ContactWorkspace& workspace, std::span<const double> times,
                                  const std::function<void(const State&)>& output,
                                  std::span<const Observer> observers, const MarchOptions& options) {
    for (std::size_t k = 0; k < times.size(); ++k) {
        if (!(times[k] >= grid.t0 && times[k] <= grid.t(grid.steps)))
            throw InputError("integrate_with_output: times[" + std::to_string(k) + "] is " +
                             std::to_string(times[k]) + ", expected within the grid");
        if (k > 0 && times[k] <= times[k - 1])
            throw InputError("integrate_with_output: times[" + std::to_string(k) + "] is " +
                             std::to_string(times[k]) + ", expected more than the one before");
    }
    std::size_t next = 0;
    State between;
    return march_through(method, problem, grid, workspace, options, [&](const Run& run, const StepReport& report) {
        for (; next < times.size() && times[next] <= run.state().t; ++next) {
            if (times[next] == run.state().t) {
                output(run.state());
                continue;
            }
            between = run.state();
            run.dense(times[next], between);
            output(between);
        }
        return tell(observers, run.state(), report) ? Flow::proceed : Flow::stop;
    });
}

MarchReport integrate_until(const Integrator& method, const ContactProblem& problem, const TimeGrid& grid,
                            const ContactWorkspace& workspace, const std::function<double(const State&)>& g,
                            double tolerance, const MarchOptions& options) {
    double sign = 0, before = grid.t0;
    State found;
    const auto changed = [&](const State& state) {
        const double value = g(state);
        if (sign == 0) sign = value;
        return sign * value < 0;
    };
    MarchReport march =
        march_through(method, problem, grid, workspace, options, [&](const Run& run, const StepReport&) {
            const State& state = run.state();
            if (!changed(state)) {
                before = state.t;
                return Flow::proceed;
            }
            found = state;
            State middle = state;
            double low = before, high = state.t;
            while (high - low > tolerance * (state.t - before)) {
                const double t = 0.5 * (low + high);
                if (!(t > low && t < high)) break;
                run.dense(t, middle);
                if (changed(middle)) {
                    high = t;
                    std::swap(found, middle);
                } else {
                    low = t;
                }
            }
            return Flow::stop;
        });
    if (march.outcome == Outcome::stopped) march.final_state = std::move(found);
    return march;
}

ContactProblem restarted(const ContactProblem& problem, const State& state) {
    ContactProblem later = problem;
    later.u0 = state.u();
    if (problem.second_order()) later.v0 = state.v();
    return later;
}

}  // namespace tact
