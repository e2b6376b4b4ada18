#include "work_precision_run.hpp"

#include <algorithm>
#include <cmath>

#include "../../../integrators/central_difference.hpp"
#include "../../../lib/time/energy.hpp"
#include "../../harness/interrupt.hpp"
#include "../../harness/methods.hpp"
#include "../../harness/report.hpp"
#include "../../harness/timing.hpp"

namespace tact::bench {
namespace {

constexpr double rounding = 1e-9;  // of a step: output times this close to its end are its end

TimeGrid grid_of(const PrecisionMethod& method, double parameter, const PrecisionScene& scene) {
    if (method.adaptive) return {scene.t_end, 1, 0};
    return {scene.t_end / parameter, std::lround(parameter), 0};
}

/// The impulse of the contact forces' sum, from what a method reports at the ends of its steps.
class Impulse {
public:
    explicit Impulse(bool mean_force) : mean_force_(mean_force) {}
    void add(const State& state) {
        const double force = state.lambda.sum();
        // The initial state has no multipliers: the first step's force stands for it.
        const double first = mean_force_ || state.step == 1 ? force : force_;
        before_ = now_;
        now_ += (state.t - t_) * 0.5 * (first + force);
        before_t_ = t_;
        t_ = state.t;
        force_ = force;
    }
    double at(double t) const { return before_ + (now_ - before_) * (t - before_t_) / (t_ - before_t_); }

private:
    bool mean_force_;
    double t_ = 0, before_t_ = 0, now_ = 0, before_ = 0, force_ = 0;
};

double drift(const std::vector<Energy>& history) {
    double largest = 0;
    for (const Energy& energy : history) largest = std::max(largest, energy.mechanical());
    const Energy &first = history.front(), &last = history.back();
    return (last.mechanical() - last.external_work - last.damping_work - first.mechanical()) / largest;
}

/// CPU seconds of further marches on fresh workspaces, which nothing watches.
void time_marches(const Integrator& method, const PrecisionScene& scene, const TimeGrid& grid,
                  const PrecisionTiming& timing, std::vector<double>& seconds) {
    double spent = 0;
    while (static_cast<int>(seconds.size()) < timing.repeats && spent < timing.enough) {
        throw_if_interrupted();
        ContactWorkspace workspace(scene.contact);
        seconds.push_back(
            seconds_of([&] { (void)integrate(method, scene.problem, grid, workspace, std::vector<Observer>{}); }));
        spent += seconds.back();
    }
}

std::string parameter_text(const PrecisionMethod& method, double parameter, const PrecisionScene& scene) {
    return method.adaptive ? "rtol=" + digits(parameter) : "dt=" + digits(scene.t_end / parameter, 6);
}

}  // namespace

Shared<Integrator> PrecisionMethod::make(double tolerance) const {
    if (!adaptive) return integrator(name);
    return integrator(name + (name.find(':') == std::string::npos ? ":" : ",") + "rtol=" + digits(tolerance, 6));
}

const std::vector<PrecisionMethod>& precision_methods() {
    static const std::vector<PrecisionMethod> all{
        {"bdf2", false, false},         {"bdf2-without-jump", false, true}, {"central-difference", false, true, true},
        {"trapezoid", false, true},     {"trapezoid:rho=0.3", false, true}, {"moreau-jean", false, true},
        {"ida-fixed", false, false},    {"sdirk2", false, false},           {"tr-bdf2", false, false},
        {"esdirk32", false, false},     {"sdirk54", false, false},          {"ida", true, false},
        {"sdirk2", true, false},        {"tr-bdf2", true, false},           {"esdirk32", true, false},
        {"sdirk54", true, false},       {"sdirk2:e=0", false, false},       {"tr-bdf2:e=0", false, false},
        {"esdirk32:e=0", false, false}, {"sdirk54:e=0", false, false},      {"ida:e=0", true, false},
        {"sdirk2:e=0", true, false},    {"tr-bdf2:e=0", true, false},       {"esdirk32:e=0", true, false},
        {"sdirk54:e=0", true, false}};
    return all;
}

std::vector<PrecisionMethod> precision_methods_for(const PrecisionScene& scene) {
    std::vector<PrecisionMethod> methods = precision_methods();
    if (!scene.impacts) std::erase_if(methods, [](const PrecisionMethod& method) { return method.has_impact_law(); });
    const Vector* mass = scene.problem.M ? scene.problem.M->diagonal_entries() : nullptr;
    if (mass && !(mass->array() > 0).all())
        std::erase_if(methods, [](const PrecisionMethod& method) { return method.explicit_steps; });
    return methods;
}

std::vector<double> parameters_of(const PrecisionMethod& method, const PrecisionScene& scene) {
    if (method.adaptive) return scene.tolerances;
    std::vector<double> steps(scene.steps.begin(), scene.steps.end());
    if (!method.explicit_steps) return steps;
    ContactWorkspace workspace(scene.contact);
    constexpr double below = 0.99;  // at the limit itself the fastest mode grows
    const double largest = below * CentralDifference::largest_step(scene.problem, workspace);
    const auto outputs = static_cast<double>(scene.outputs);
    steps[0] = outputs * std::ceil(scene.t_end / (outputs * largest));
    for (std::size_t k = 1; k < steps.size(); ++k) steps[k] = 2 * steps[k - 1];
    return steps;
}

Recorded record(const PrecisionMethod& method, double parameter, const PrecisionScene& scene, Ledgers ledgers,
                double limit) {
    const TimeGrid grid = grid_of(method, parameter, scene);
    const auto made = method.make(parameter);
    ContactWorkspace workspace(scene.contact);
    Recorded recorded;
    double since = cpu_seconds();
    const auto pause = [&] { recorded.seconds += cpu_seconds() - since; };
    const auto run = made->start(scene.problem, grid, workspace);
    pause();
    recorded.u.resize(scene.problem.size(), scene.outputs);
    recorded.impulse.resize(scene.outputs);
    ImpactLedger impacts(scene.problem);
    EnergyLedger energy(scene.problem);
    std::vector<Observer> observers;
    if (ledgers == Ledgers::kept) observers = {impacts.observer(), energy.observer()};
    for (const Observer& observer : observers) (void)observer(run->state(), {});
    Impulse impulse(method.mean_force);
    State between = run->state();
    long next = 0;
    while (next < scene.outputs) {
        throw_if_interrupted();
        const double from = run->state().t;
        since = cpu_seconds();
        const StepReport report = run->advance();
        pause();
        if (recorded.seconds > limit) {
            recorded.outcome = Outcome::stopped;
            return recorded;
        }
        if (report.outcome != Outcome::converged) {
            recorded.outcome = report.outcome;
            recorded.detail = report.detail;
            return recorded;
        }
        ++recorded.steps;
        const State& state = run->state();
        for (const Observer& observer : observers) (void)observer(state, report);
        impulse.add(state);
        const double close = rounding * (state.t - from);
        for (; next < scene.outputs && scene.output(next + 1) <= state.t + close; ++next) {
            const double t = scene.output(next + 1);
            if (t < state.t - close)
                run->dense(t, between);
            else
                between = state;
            recorded.u.col(next) = between.u();
            recorded.impulse[next] = impulse.at(t);
        }
    }
    if (ledgers == Ledgers::none) return recorded;
    recorded.energy_drift = drift(energy.history());
    recorded.impacts = impacts.summary();
    return recorded;
}

double error_u(const PrecisionScene& scene, const DenseMatrix& u, const Reference& reference) {
    const auto norm = [&](const Vector& x) { return std::sqrt(x.dot(*scene.problem.M * x)); };
    double error = 0, size = 0;
    for (Index k = 0; k < u.cols(); ++k) {
        error = std::max(error, norm(u.col(k) - reference.u.col(k)));
        size = std::max(size, norm(reference.u.col(k)));
    }
    return error / size;
}

double error_lambda(const Vector& impulse, const Reference& reference) {
    return (impulse - reference.impulse).norm() / reference.impulse.norm();
}

Json empty_precision_row(const PrecisionScene& scene, const std::string& integrator, const std::string& parameter) {
    Json row{{"scene", scene.name}, {"integrator", integrator}, {"parameter", parameter}};
    for (const char* field :
         {"steps", "seconds", "error_u", "error_lambda", "energy_drift", "restitution_min", "restitution_max"})
        row[field] = nullptr;
    row["outcome"] = "converged";
    return row;
}

Json untried_row(const PrecisionScene& scene, const PrecisionMethod& method, double parameter) {
    Json row = empty_precision_row(scene, method.label(), parameter_text(method, parameter, scene));
    row["outcome"] = "not tried: the one before took too long";
    return row;
}

Json precision_row(const PrecisionScene& scene, const PrecisionMethod& method, double parameter,
                   const PrecisionTiming& timing) {
    Json row = empty_precision_row(scene, method.label(), parameter_text(method, parameter, scene));
    try {
        const auto reference = scene.reference(method);
        const Recorded recorded = record(method, parameter, scene, Ledgers::kept, timing.limit);
        if (recorded.outcome != Outcome::converged) {
            row["outcome"] = recorded.outcome == Outcome::stopped ? "not done in " + digits(timing.limit) + " s"
                                                                  : std::string(to_string(recorded.outcome));
            if (!recorded.detail.empty()) row["message"] = recorded.detail;
            return row;
        }
        std::vector<double> seconds;
        if (recorded.seconds > timing.enough)
            seconds = {recorded.seconds};
        else
            time_marches(*method.make(parameter), scene, grid_of(method, parameter, scene), timing, seconds);
        row["steps"] = recorded.steps;
        row["seconds"] = median(seconds);
        row["error_u"] = error_u(scene, recorded.u, *reference);
        if (scene.problem.constraints() > 0) row["error_lambda"] = error_lambda(recorded.impulse, *reference);
        row["energy_drift"] = recorded.energy_drift;
        if (recorded.impacts.impacts > 0) {
            row["restitution_min"] = recorded.impacts.restitution_min;
            row["restitution_max"] = recorded.impacts.restitution_max;
        }
    } catch (const NumericalError& error) {
        row["outcome"] = "error";
        row["message"] = error.what();
    }
    return row;
}

}  // namespace tact::bench
