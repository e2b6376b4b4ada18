#include "tact/integrators/sundials/stage_hook.hpp"

#include <nvector/nvector_serial.h>

namespace tact::sundials {

int StageHook::solve(SUNNonlinearSolver solver, N_Vector, N_Vector correction, N_Vector, realtype, booleantype,
                     void* memory) {
    auto& content = *static_cast<Content*>(solver->content);
    ++content.solves;
    try {
        Position position;
        if (const int flag = content.fetch(memory, position); flag != 0) return flag;
        State& target = *content.target;
        const Eigen::Map<const Vector> b(NV_DATA_S(position.b), NV_LENGTH_S(position.b));
        const Index n = target.n;
        content.report =
            content.stages->solve(Stage{position.t, position.a, b.head(n), b.tail(b.size() - n)}, target);
        if (content.report.outcome != Outcome::converged) return SUN_NLS_CONV_RECVR;
        if (position.predicted) {
            Eigen::Map<Vector> change(NV_DATA_S(correction), NV_LENGTH_S(correction));
            change = target.y - Eigen::Map<const Vector>(NV_DATA_S(position.predicted), NV_LENGTH_S(correction));
        }
        return SUN_NLS_SUCCESS;
    } catch (...) {
        content.caught = std::current_exception();
        return SUN_NLS_MEM_FAIL;
    }
}

StageHook::StageHook(const Context& context, StageSolver& stages, State& target, Fetch fetch)
    : content_{&stages, &target, fetch, {}, {}}, solver_(SUNNonlinSolNewEmpty(context.get())) {
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
