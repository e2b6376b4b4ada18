// Dense output of the steppers that know u and v at both ends of a step.
#pragma once

#include <string>

#include "../lib/time/stage.hpp"

namespace tact {

/// The cubic through u and v at both ends; linear for problems of first order. InputError if t is not between them.
inline void interpolate(const State& before, const State& now, double t, State& out) {
    const double h = now.t - before.t;
    if (!(t >= before.t && t <= now.t) || !(h > 0))
        throw InputError("dense output: t is " + shown(t) + ", expected in the last step, from " + shown(before.t) +
                         " to " + shown(now.t));
    const double s = (t - before.t) / h;
    out = now;
    out.t = t;
    if (now.v().size() == 0) {
        out.y = (1 - s) * before.y + s * now.y;
        return;
    }
    const double down = 1 - s;
    out.u() = down * down * ((1 + 2 * s) * before.u() + h * s * before.v()) +
              s * s * ((1 + 2 * down) * now.u() - h * down * now.v());
    out.v() = 6 * s * down / h * (now.u() - before.u()) + down * (1 - 3 * s) * before.v() + s * (3 * s - 2) * now.v();
}

}  // namespace tact
