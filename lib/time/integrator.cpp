#include "integrator.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "../algebra/empty_rows.hpp"

namespace tact {

TimeGrid TimeGrid::until(double t_end, double dt) {
    if (!(dt > 0) || !std::isfinite(dt)) throw InputError("TimeGrid: dt is " + shown(dt) + ", expected > 0");
    const double steps = t_end / dt;
    constexpr double countable = 9007199254740992;  // 2^53: doubles above it skip whole numbers
    if (!(steps >= 0 && steps <= countable))
        throw InputError("TimeGrid: t_end is " + shown(t_end) + ", which is " + shown(steps) +
                         " steps of dt = " + shown(dt) + ", expected 0 to 2^53");
    const double rounding = 2 * std::numeric_limits<double>::epsilon() * steps;
    if (std::abs(steps - std::round(steps)) > std::max(1e-6, rounding))
        throw InputError("TimeGrid: t_end is " + shown(t_end) + ", which is " + shown(steps) +
                         " steps of dt = " + shown(dt) + ", expected a whole number of steps");
    const TimeGrid grid{dt, std::lround(steps), 0};
    validate(grid);
    return grid;
}

void validate(const TimeGrid& grid) {
    const auto expected = [](const char* field, const std::string& found, const std::string& expectation) {
        throw InputError(std::string("TimeGrid: ") + field + " is " + found + ", expected " + expectation);
    };
    if (!(grid.dt > 0) || !std::isfinite(grid.dt)) expected("dt", shown(grid.dt), "> 0");
    if (grid.steps < 0) expected("steps", std::to_string(grid.steps), ">= 0");
    if (!std::isfinite(grid.t0)) expected("t0", shown(grid.t0), "a finite time");
    const double end = grid.t(grid.steps), largest = std::max(std::abs(grid.t0), std::abs(end));
    if (!std::isfinite(end)) expected("its end, t0 + steps dt,", shown(end), "a finite time");
    // A point is rounded twice, in n dt and in the sum, each time by half a unit: two units apart they may still meet.
    const double unit = std::nextafter(largest, infinity) - largest;
    if (grid.steps > 0 && !(grid.dt > 4 * unit))
        expected("dt", shown(grid.dt),
                 "more than " + shown(4 * unit) + ": at t = " + shown(largest) + " its steps are lost in rounding");
}

namespace {

bool tell(std::span<const Observer> observers, const State& state, const StepReport& report) {
    bool proceed = true;
    for (const Observer& observer : observers) proceed &= observer(state, report) == Flow::proceed;
    return proceed;
}

/// The row of the largest violation of u0 in units of the row's own size, and that violation.
std::pair<Index, double> initial_violation(const ContactProblem& problem, const Vector& c, const Vector& upper) {
    const Vector place = problem.B * problem.u0;
    std::pair<Index, double> worst{0, 0};
    const double size = problem.u0.lpNorm<Eigen::Infinity>();
    const auto look_at = [&](Index i, double bound, double beyond) {
        const double violation = beyond / std::max({std::abs(bound), std::abs(place[i]), size, 1e-300});
        if (violation > worst.second) worst = {i, violation};
    };
    const std::vector<Index> empty = empty_rows(problem.B);
    for (Index i = 0; i < place.size(); ++i) {
        // No u0 repairs an empty row: what it asks is judged in the steps.
        if (std::binary_search(empty.begin(), empty.end(), i)) continue;
        if (c[i] > -infinity) look_at(i, c[i], c[i] - place[i]);
        if (upper.size() > 0 && upper[i] < infinity) look_at(i, upper[i], place[i] - upper[i]);
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
    Vector c = problem.c.at(t0);
    Vector upper = problem.c_up ? problem.c_up->at(t0) : Vector();
    // A row that may give way is violated by nothing.
    for (Index i = 0; i < c.size(); ++i) {
        if (problem.force_up.size() > 0 && problem.force_up[i] < infinity) c[i] = -infinity;
        if (upper.size() > 0 && problem.force_lo.size() > 0 && problem.force_lo[i] > -infinity) upper[i] = infinity;
    }
    const auto [row, violation] = initial_violation(problem, c, upper);
    if (violation <= rounding) return Shared<ContactProblem>::borrowed(problem);
    if (options.initial_penetration == InitialPenetration::reject)
        throw InputError("ContactProblem: u0 penetrates row " + std::to_string(row) + " by " +
                         shown(100 * violation) + " % of its size, expected B u0 >= c(t0)" +
                         (problem.c_up ? " and B u0 <= c_up(t0)" : "") + "; see InitialPenetration");
    const Combination metric = problem.M ? Combination{1, 0, 0} : problem.D ? Combination{0, 1, 0} : Combination{};
    ContactProblem repaired = problem;
    Vector lambda = Vector::Zero(problem.constraints());
    const Vector b = combined(problem, metric) * problem.u0;
    const RowBounds rows(c, problem.c_up ? &upper : nullptr);
    const ContactReport report = workspace.prepared(problem, metric)->solve_rows(b, rows, {repaired.u0, lambda});
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
    validate(grid);
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
            if (given.c.constant())
                if (const std::string row = contradiction_of_empty_row(march.last.contact, given.B, given.c.at(0));
                    !row.empty())
                    throw InputError("ContactProblem: " + row);
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
            throw InputError("integrate_with_output: times[" + std::to_string(k) + "] is " + shown(times[k]) +
                             ", expected within the grid");
        if (k > 0 && times[k] <= times[k - 1])
            throw InputError("integrate_with_output: times[" + std::to_string(k) + "] is " + shown(times[k]) +
                             ", expected more than the one before");
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
