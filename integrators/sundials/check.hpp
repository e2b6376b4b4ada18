// Return codes of SUNDIALS' calls.
#pragma once

#include <string>

#include "../../lib/errors.hpp"

namespace tact::sundials {

/// NumericalError that names the call, unless the flag says success.
inline void check(int flag, const char* call) {
    if (flag < 0) throw NumericalError(std::string("SUNDIALS: ") + call + " returned " + std::to_string(flag));
}

/// Messages go into reports and exceptions, not to standard error.
inline void keep_quiet(int, const char*, const char*, char*, void*) {}

}  // namespace tact::sundials
