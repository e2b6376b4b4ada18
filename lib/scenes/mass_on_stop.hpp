// One mass above a rigid stop: a ball that bounces.
#pragma once

#include "mesh.hpp"

namespace tact {

/// Any consistent units.
struct MassOnStopData {
    double mass = 1;
    double gravity = 1;    ///< towards the stop
    double stiffness = 0;  ///< of a spring that is slack at the stop
    double height = 1;     ///< at first
    double velocity = 0;   ///< at first, positive away from the stop
};

/// mass u_tt + stiffness u = -mass gravity + lambda, u >= 0. One unknown, one row.
/// InputError unless mass is positive, gravity, stiffness and height are not negative, and all are finite.
Scene mass_on_stop(const MassOnStopData& data = {});

/// What holds at one time. At an impact, before it.
struct BounceState {
    double u = 0, v = 0;
    double impulse = 0;  ///< of the contact force since the beginning, the weight it carries at rest included
    long impacts = 0;    ///< so far; -1: infinitely many, it lies on the stop
};

/// The exact trajectory where each impact returns `restitution` times the speed: harmonic or parabolic flights in closed
/// form, each as long as its first speed says, and rest after the accumulation of impacts that restitution < 1 ends in.
/// A mass that does not fall (no gravity, no spring) leaves for ever. InputError as above and for restitution outside [0, 1].
BounceState bouncing_ball(const MassOnStopData& data, double restitution, double t);

}  // namespace tact
