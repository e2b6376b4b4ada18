// What the adaptive integrators check and tell of their options.
#pragma once

#include <cmath>
#include <string>

#include "../lib/errors.hpp"
#include "../lib/time/naming.hpp"

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

/// The options that Ida and Arkode share; what is as usual is not named but for the tolerances.
template <class Options> void add_step_control(WithOptions& name, const Options& options) {
    const Options usual;
    name.add("rtol", options.rtol).add("atol", options.atol);
    if (options.restitution) name.add("e", *options.restitution);
    name.add_unless(usual.first_step, "first_step", options.first_step)
        .add_unless(usual.max_step, "max_step", options.max_step)
        .add_unless(static_cast<double>(usual.most_steps), "most_steps", static_cast<double>(options.most_steps))
        .add_unless(usual.newton, "newton", options.newton);
}

}  // namespace tact
