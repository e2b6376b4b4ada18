#include "stage_hook.hpp"

namespace tact::sundials {

int StageHook::solve(SUNNonlinearSolver solver, N_Vector, N_Vector correction, N_Vector, realtype, booleantype,
                     void*) {
    auto& content = *static_cast<Content*>(solver->content);
    ++content.solves;
    try {
        content.report = content.stages->solve(content.client->stage(), *content.target);
        content.worst.raise_to(content.report.kkt);
        content.report.kkt = content.worst;
        // A smaller step does not make a load, a gap or r(u) finite.
        if (content.report.outcome == Outcome::not_finite) return SUN_NLS_MEM_FAIL;
        if (content.report.outcome != Outcome::converged) return SUN_NLS_CONV_RECVR;
        content.client->correct(correction);
        return SUN_NLS_SUCCESS;
    } catch (...) {
        content.caught = std::current_exception();
        return SUN_NLS_MEM_FAIL;
    }
}

StageHook::StageHook(const Context& context, StageSolver& stages, State& target, Client& client)
    : content_{&stages, &target, &client, {}, {}, {}}, solver_(SUNNonlinSolNewEmpty(context.get())) {
    if (!solver_) throw NumericalError("SUNDIALS: SUNNonlinSolNewEmpty failed");
    auto* ops = solver_->ops;
    ops->gettype = [](SUNNonlinearSolver) { return SUNNONLINEARSOLVER_ROOTFIND; };
    ops->initialize = [](SUNNonlinearSolver) { return int{SUN_NLS_SUCCESS}; };
    ops->solve = &StageHook::solve;
    ops->free = [](SUNNonlinearSolver s) {
        s->content = nullptr;
        SUNNonlinSolFreeEmpty(s);
        return int{SUN_NLS_SUCCESS};
    };
    ops->setsysfn = [](SUNNonlinearSolver, SUNNonlinSolSysFn) { return int{SUN_NLS_SUCCESS}; };
    ops->getnumiters = [](SUNNonlinearSolver s, long* count) {
        *count = static_cast<Content*>(s->content)->solves;
        return int{SUN_NLS_SUCCESS};
    };
    solver_->content = &content_;
}

StageHook::~StageHook() { SUNNonlinSolFree(solver_); }

void StageHook::rethrow() {
    if (content_.caught) std::rethrow_exception(std::exchange(content_.caught, nullptr));
}

}  // namespace tact::sundials
