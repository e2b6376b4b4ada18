#include "linear_hook.hpp"

#include <utility>

#include "../../lib/errors.hpp"

namespace tact::sundials {

LinearHook::LinearHook(const Context& context, Client& client)
    : content_{&client, {}}, solver_(SUNLinSolNewEmpty(context.get())) {
    if (!solver_) throw NumericalError("SUNDIALS: SUNLinSolNewEmpty failed");
    auto* ops = solver_->ops;
    ops->gettype = [](SUNLinearSolver) { return SUNLINEARSOLVER_MATRIX_EMBEDDED; };
    ops->solve = [](SUNLinearSolver self, SUNMatrix, N_Vector x, N_Vector b, realtype) -> int {
        auto& content = *static_cast<Content*>(self->content);
        try {
            content.client->solve_linear(x, b);
            return SUNLS_SUCCESS;
        } catch (const NumericalError&) {
            content.caught = std::current_exception();
            return SUNLS_PACKAGE_FAIL_REC;
        } catch (...) {
            content.caught = std::current_exception();
            return SUNLS_PACKAGE_FAIL_UNREC;
        }
    };
    ops->free = [](SUNLinearSolver self) {
        self->content = nullptr;
        SUNLinSolFreeEmpty(self);
        return int{SUNLS_SUCCESS};
    };
    solver_->content = &content_;
}

LinearHook::~LinearHook() { SUNLinSolFree(solver_); }

void LinearHook::rethrow() {
    if (content_.caught) std::rethrow_exception(std::exchange(content_.caught, nullptr));
}

}  // namespace tact::sundials
