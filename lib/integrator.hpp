// Stepping in time: an immutable recipe, the run it starts, and what each step reports.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "tact/lib/stage.hpp"

namespace tact {

/// t_n = t0 + n dt, never accumulated.
struct TimeGrid {
    double dt = 0;
    long steps = 0;
    double t0 = 0;
    double t(long n) const { return t0 + static_cast<double>(n) * dt; }
    /// The grid from 0 to t_end; InputError unless dt > 0 and t_end is a whole number of steps (to 1e-6 of one).
    static TimeGrid until(double t_end, double dt);
};

/// What one step came to. On any outcome but `converged` the run's state is that before the step.
struct [[nodiscard]] StepReport {
    double t = 0;   ///< the time the step aimed at
    long step = 0;  ///< its number, from 1
    Outcome outcome = Outcome::converged;
    ContactReport contact;
};

/// A march under way. Owns its state and work space.
class Run {
public:
    virtual ~Run() = default;
    virtual const State& state() const = 0;
    /// One step. No retry: that is the caller's policy.
    virtual StepReport advance() = 0;
};

/// An immutable recipe for stepping contact problems, full or reduced.
class Integrator {
public:
    virtual ~Integrator() = default;
    virtual std::string name() const = 0;
    /// `problem` and `workspace` must outlive the run. InputError if this integrator cannot take the problem.
    virtual std::unique_ptr<Run> start(const ContactProblem& problem, const TimeGrid& grid,
                                       ContactWorkspace& workspace) const = 0;
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
    KktResiduals worst_kkt;  ///< each residual's largest value over the accepted steps
    State final_state;
};

/// validate(problem), then step through the grid.
MarchReport integrate(const Integrator& method, const ContactProblem& problem, const TimeGrid& grid,
                      ContactWorkspace& workspace, std::span<const Observer> observers = {});

}  // namespace tact
