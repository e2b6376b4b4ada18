// Where adaptive runs must end a step.
#pragma once

#include <algorithm>
#include <cmath>

#include "../../lib/problem/contact_problem.hpp"

namespace tact::sundials {

/// The first jump of load or gap after t, else the end: an error test that looks at both ends of a step sees no pulse
/// between them.
inline double next_stop(const ContactProblem& problem, double t, double end) {
    const double close = 1e-12 * std::max(std::abs(t), std::abs(end));
    double stop = end;
    for (const auto* jumps : {&problem.f.jumps, &problem.c.jumps})
        for (const double jump : *jumps)
            if (jump > t + close && jump < stop - close) stop = jump;
    return stop;
}

/// The time at which a stage in a step to `stop` is asked for: its end belongs to what was before the jump.
inline double before_stop(double t, double stop) { return t >= stop ? std::nextafter(stop, -infinity) : t; }

}  // namespace tact::sundials
