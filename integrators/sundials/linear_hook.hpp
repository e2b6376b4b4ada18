// A SUNLinearSolver that is its own matrix: SUNDIALS' Newton iterations on scenes without contact.
#pragma once

#include <sundials/sundials_linearsolver.h>

#include <exception>

#include "context.hpp"

namespace tact::sundials {

/// Type MATRIX_EMBEDDED. A solve asks the client for x = J^-1 b at the state its integrator stands at. Exceptions are
/// kept and raised again by `rethrow`: a NumericalError is recoverable to SUNDIALS (it tries a smaller step), anything
/// else is not. Codes are SUNLS_*: a bare +1 would be taken for success.
class LinearHook {
public:
    class Client {
    public:
        virtual void solve_linear(N_Vector x, N_Vector b) = 0;

    protected:
        ~Client() = default;
    };
    LinearHook(const Context& context, Client& client);
    ~LinearHook();
    LinearHook(const LinearHook&) = delete;
    LinearHook& operator=(const LinearHook&) = delete;

    SUNLinearSolver get() const { return solver_; }
    void rethrow();
    /// What was recoverable and recovered from is forgotten.
    void forget() { content_.caught = nullptr; }

private:
    struct Content {
        Client* client;
        std::exception_ptr caught;
    };
    Content content_;
    SUNLinearSolver solver_;
};

}  // namespace tact::sundials
