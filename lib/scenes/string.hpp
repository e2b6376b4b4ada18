// Strings over obstacles: one plucked above a point, one that is held by nothing but a hill.
#pragma once

#include "bar.hpp"
#include "membrane.hpp"

namespace tact {

/// Any consistent units.
struct PluckedStringData {
    double length = 1;
    double tension = 1;
    double density = 1;     ///< mass per length
    double height = 0.1;    ///< of the pluck
    double pluck = 0.5;     ///< where, as a fraction of the length
    double obstacle = 0.5;  ///< where the point obstacle touches the line of rest, likewise
};

/// density u_tt = tension u_xx on (0, length), u = 0 at both ends, u >= 0 at the obstacle's point; released at rest from the
/// triangle with its top at the pluck. elements - 1 unknowns and one row; lambda is the obstacle's force.
/// InputError for bad data, or if the obstacle is not at a node.
/// (Cabannes, Formulas for vibrating strings with obstacles, 2001; Schatzman, J. Math. Anal. Appl. 73, 1980.)
Scene plucked_string(Index elements, const PluckedStringData& data = {}, Mass mass = Mass::lumped);

/// The exact motion where pluck and obstacle are at the middle: by symmetry each half is a bar that bounces, so the period is
/// 3/2 length/c instead of the free string's 2 length/c, and the energy stays. The stress is tension u_x.
/// InputError for another pluck or obstacle.
BarState plucked_string_exact(const PluckedStringData& data, double x, double t);
/// The obstacle's force: 4 tension height/length in the middle third of each period, else zero.
double plucked_string_force(const PluckedStringData& data, double t);

/// Any consistent units.
struct DrapedStringData {
    double length = 1;
    double tension = 1;
    double density = 1;
    double gravity = 1;
    double curvature = 1;  ///< of the hill at its top
    double height = 0.1;   ///< of the string above the top, at first
    double damping = 0;    ///< force per length and velocity
};

/// density u_tt + damping u_t = tension u_xx - density gravity above the hill -curvature x^2/2, -length/2 < x < length/2, both
/// ends free to slide: nothing but contact holds it, K is singular. Contact at every node, cell by cell; straight and at rest
/// at first. Motion::none: without M and D, the equilibrium on the hill.
/// InputError for bad data.
Scene draped_string(Index elements, const DrapedStringData& data = {}, Motion motion = Motion::dynamic);

/// Where it comes to rest: on the hill for |x| < s, s/(length/2) = q/(q + tension curvature) with the weight per length
/// q = density gravity; beyond, u = -curvature s^2/2 - curvature s (|x| - s) + q (|x| - s)^2/(2 tension). On the hill the
/// obstacle carries q + tension curvature per length: in all, the weight.
double draped_string_rest(const DrapedStringData& data, double x);

}  // namespace tact
