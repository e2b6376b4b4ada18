// The one nonlinear solver every SUNDIALS integrator is given: it solves the implicit stage, contact included.
#pragma once

#include <sundials/sundials_nonlinearsolver.h>

#include <exception>

#include "../../lib/time/stage.hpp"
#include "context.hpp"

namespace tact::sundials {

/// A SUNNonlinearSolver of type ROOTFIND. SUNNonlinSolSolve asks its client what stage the integrator stands at, solves
/// it into the target state, and lets the client write the correction. The multipliers stay outside SUNDIALS' state.
/// Exceptions do not cross the C caller: they are kept, a failure code goes back, and `rethrow` raises them again.
class StageHook {
public:
    /// The run that an integrator's memory belongs to.
    class Client {
    public:
        /// The stage: y' = a y + b at t; b stays valid until `correct`. Puts its guess into the target state.
        virtual Stage stage() = 0;
        /// From the target state to what the integrator calls its correction.
        virtual void correct(N_Vector correction) = 0;

    protected:
        ~Client() = default;
    };

    /// The stage solver, the target and the client must outlive the hook.
    StageHook(const Context& context, StageSolver& stages, State& target, Client& client);
    ~StageHook();
    StageHook(const StageHook&) = delete;
    StageHook& operator=(const StageHook&) = delete;

    SUNNonlinearSolver get() const { return solver_; }
    /// A new step, or a new attempt at one: the worst residuals start from nothing.
    void begin_step() { content_.worst = {}; }
    /// Of the last solve, with the worst residuals of all since begin_step.
    const ContactReport& report() const { return content_.report; }
    long solves() const { return content_.solves; }
    /// Raises what the last solve caught, if anything.
    void rethrow();

private:
    struct Content {
        StageSolver* stages;
        State* target;
        Client* client;
        ContactReport report;
        KktResiduals worst;
        std::exception_ptr caught;
        long solves = 0;
    };
    static int solve(SUNNonlinearSolver solver, N_Vector predicted, N_Vector correction, N_Vector weights,
                     realtype tolerance, booleantype call_setup, void* memory);
    Content content_;
    SUNNonlinearSolver solver_;
};

}  // namespace tact::sundials
