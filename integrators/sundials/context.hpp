// SUNDIALS' run-wide object. Declared first wherever it is used, so that it dies last; one per run.
#pragma once

#include <sundials/sundials_context.h>

#include "../../lib/errors.hpp"

namespace tact::sundials {

class Context {
public:
    Context() {
        if (SUNContext_Create(nullptr, &context_) != 0) throw NumericalError("SUNDIALS: SUNContext_Create failed");
    }
    ~Context() { SUNContext_Free(&context_); }
    Context(const Context&) = delete;
    Context& operator=(const Context&) = delete;
    SUNContext get() const { return context_; }

private:
    SUNContext context_ = nullptr;
};

}  // namespace tact::sundials
