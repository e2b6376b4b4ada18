// Stepping in time: an immutable recipe, the run it starts, and what each step reports.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "stage.hpp"

namespace tact {

/// t_n = t0 + n dt, never accumulated.
struct TimeGrid {
    double dt = 0;
    long steps = 0;
    double t0 = 0;
    double t(long n) const { return t0 + static_cast<double>(n) * dt; }
    /// The grid from 0 to t_end; InputError unless dt > 0, t_end is a whole number of steps (to 1e-6 of one) and the grid is
    /// valid.
    static TimeGrid until(double t_end, double dt);
};

/// Throws InputError unless dt > 0, steps >= 0 and all points are finite and differ: dt is lost in rounding where it is no
/// larger than four units in the last place of the largest |t|.
void validate(const TimeGrid& grid);

/// What one step came to. On any outcome but `converged` the run's state is that before the step.
struct [[nodiscard]] StepReport {
    double t = 0;   ///< the time the step aimed at
    long step = 0;  ///< its number, from 1
    Outcome outcome = Outcome::converged;
    ContactReport contact{};  ///< of the step's (last) solve for u
    std::optional<ContactReport>
        impact{};               ///< of the solve for v, in steps that end in contact, by schemes with an impact law
    std::string_view detail{};  ///< of a failure, where a library gives one; static lifetime
};

/// What an adaptive run has tried in vain, and what it cost. Zeros for fixed steps.
struct RunCounters {
    long stages = 0;          ///< implicit stages solved, rejected ones included
    long error_failures = 0;  ///< steps rejected by the error test
    long stage_failures = 0;  ///< steps given up because a stage did not converge
};

/// A march under way. Owns its state and work space.
class Run {
public:
    virtual ~Run() = default;
    virtual const State& state() const = 0;
    /// One accepted step. Fixed-step methods do not retry: that is the caller's policy. Adaptive ones choose the length
    /// of the step, and end on the grid's last point.
    virtual StepReport advance() = 0;
    /// u(t), v(t) within the last step, to the method's order. InputError for methods without dense output, or if t is
    /// not in the last step. `out.lambda` is that of the step.
    virtual void dense(double t, State& out) const;
    virtual RunCounters counters() const { return {}; }
    /// What is allowed but known to be risky about this run; empty if nothing is.
    virtual std::string_view warning() const { return {}; }
};

/// An immutable recipe for stepping contact problems, full or reduced.
class Integrator {
public:
    virtual ~Integrator() = default;
    /// As the registry reads it, options included, where it knows the method: "trapezoid:e=0.5".
    virtual std::string name() const = 0;
    /// Whether the method chooses its steps: of the grid it then takes the beginning and the end.
    virtual bool adaptive() const { return false; }
    /// The run holds the problem and the workspace. InputError if this integrator cannot take the problem.
    virtual std::unique_ptr<Run> start(const Shared<ContactProblem>& problem, const TimeGrid& grid,
                                       const ContactWorkspace& workspace) const = 0;
};

enum class Flow { proceed, stop };
/// Called with the initial state (an empty report, step 0) and after every accepted step. Can only say stop.
using Observer = std::function<Flow(const State&, const StepReport&)>;

/// How a march ended: `converged` at the end of the grid; otherwise `last` says which step failed and how.
struct [[nodiscard]] MarchReport {
    Outcome outcome = Outcome::converged;
    long accepted_steps = 0;
    StepReport last;
    long first_contact_step = 0;  ///< 0: never touched
    Index most_active = 0;
    long contact_iterations = 0;
    KktResiduals worst_kkt;  ///< each residual's largest value over the accepted steps, impacts included
    RunCounters counters;
    std::string_view warning;
    State final_state;
};

/// What to do when u0 violates the constraints (by more than 1e-9 of the row's own size).
enum class InitialPenetration {
    reject,   ///< InputError that names the worst row
    project,  ///< start from the nearest admissible u0, in the metric of M (of D, of K where there is no M)
    accept    ///< the first step repairs it, with the velocity that takes
};

struct MarchOptions {
    InitialPenetration initial_penetration = InitialPenetration::reject;
};

/// validate(problem) and validate(grid), then step through the grid.
MarchReport integrate(const Integrator& method, const ContactProblem& problem, const TimeGrid& grid,
                      const ContactWorkspace& workspace, std::span<const Observer> observers = {},
                      const MarchOptions& options = {});

/// As integrate, and tells `output` the states at `times` (sorted, within the grid) by dense output.
MarchReport integrate_with_output(const Integrator& method, const ContactProblem& problem, const TimeGrid& grid,
                                  const ContactWorkspace& workspace, std::span<const double> times,
                                  const std::function<void(const State&)>& output,
                                  std::span<const Observer> observers = {}, const MarchOptions& options = {});

/// Marches until g(state) changes its sign (from the sign it has at the start, zero being neither) and locates that time
/// by dense output to `tolerance` of the step: the final state is there, the outcome `stopped`. `converged`: no event.
MarchReport integrate_until(const Integrator& method, const ContactProblem& problem, const TimeGrid& grid,
                            const ContactWorkspace& workspace, const std::function<double(const State&)>& g,
                            double tolerance = 1e-10, const MarchOptions& options = {});

/// The problem that goes on from a state: u0 and v0 are the state's. One-step methods go on as if never interrupted;
/// multistep ones begin anew. Hand integrate a grid with t0 = state.t.
ContactProblem restarted(const ContactProblem& problem, const State& state);

/// One line where all is well; else also what was tried and what to try.
std::ostream& operator<<(std::ostream& out, const StepReport& report);
std::ostream& operator<<(std::ostream& out, const MarchReport& report);

}  // namespace tact
