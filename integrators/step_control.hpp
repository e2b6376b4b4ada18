// What the adaptive integrators check of their options.
#pragma once

#include <cmath>
#include <string>

#include "../lib/errors.hpp"

namespace tact {

/// InputError unless rtol and atol are positive and finite and neither first_step nor max_step is negative. `who` is named.
template <class Options> void check_step_control(const std::string& who, const Options& options) {
    const auto positive = [&](const char* name, double value) {
        if (!(value > 0) || !std::isfinite(value))
            throw InputError(who + ": " + name + " is " + shown(value) + ", expected > 0");
    };
    positive("rtol", options.rtol);
    positive("atol", options.atol);
    if (!(options.first_step >= 0) || !(options.max_step >= 0))
        throw InputError(who + ": first_step is " + shown(options.first_step) + " and max_step is " +
                         shown(options.max_step) + ", expected neither negative");
}

}  // namespace tact
