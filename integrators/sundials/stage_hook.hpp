// The one nonlinear solver every SUNDIALS integrator is given: it solves the implicit stage, contact included.
#pragma once

#include <sundials/sundials_nonlinearsolver.h>

#include <exception>

#include "tact/integrators/sundials/context.hpp"
#include "tact/lib/stage.hpp"

namespace tact::sundials {

/// A SUNNonlinearSolver of type ROOTFIND. SUNNonlinSolSolve asks `fetch` what stage the integrator stands at, solves
/// it into the target state, and writes the correction y - y_predicted. The multipliers stay outside SUNDIALS' state.
/// Exceptions do not cross the C caller: they are kept, a failure code goes back, and `rethrow` raises them again.
class StageHook {
public:
    /// What an integrator's memory says of its stage: y' = a y + b at t, and its predictor (null: the correction is
    /// the new y itself, already in the target's storage).
    struct Position {
        double t = 0;
        double a = 0;
        N_Vector b = nullptr;
        N_Vector predicted = nullptr;
    };
    using Fetch = int (*)(void* integrator_memory, Position& position);

    /// The stage solver and the target must outlive the hook.
    StageHook(const Context& context, StageSolver& stages, State& target, Fetch fetch);
    ~StageHook();
    StageHook(const StageHook&) = delete;
    StageHook& operator=(const StageHook&) = delete;

    SUNNonlinearSolver get() const { return solver_; }
    const ContactReport& report() const { return content_.report; }
    /// Raises what the last solve caught, if anything.
    void rethrow();

private:
    struct Content {
        StageSolver* stages;
        State* target;
        Fetch fetch;
        ContactReport report;
        std::exception_ptr caught;
        long solves = 0;
    };
    static int solve(SUNNonlinearSolver solver, N_Vector predicted, N_Vector correction, N_Vector weights,
                     realtype tolerance, booleantype call_setup, void* memory);
    Content content_;
    SUNNonlinearSolver solver_;
};

}  // namespace tact::sundials
