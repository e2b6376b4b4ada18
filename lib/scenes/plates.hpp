// Two clamped plates, one above the other; a blow to the lower one drives it against the upper one.
#pragma once

#include "mesh.hpp"

namespace tact {

/// SI units. Steel, 1 mm thick.
struct PlatesData {
    double stiffness = 5000.0 / 273;  ///< D = E h^3 / (12 (1 - nu^2)), N m: E = 200 GPa, h = 1 mm, nu = 0.3
    double mass = 7.8;                ///< rho h, kg/m^2
    double gap = 0.04;                ///< between the plates at rest, m
    double pressure = 1e5;            ///< of the blow at its centre and its beginning, N/m^2
    double blow_at = 10 * 2e-4;       ///< s
};

/// mass u_tt + stiffness lap lap u = f on two unit squares, u and its normal derivative zero at the edges, both at rest:
///   f = pressure exp(-100 ((x - .3)^2 + (y - .4)^2)) H(t - blow_at) exp(-1e4 (t - blow_at)^2)  on the lower plate,
/// H(0) = 1, and its left limit where Side::left is asked for. Contact node by node: u_upper - u_lower + gap >= 0.
///
/// Thirteen-point stencil on n x n interior nodes each with ghost nodes u_-1 = u_1 outside the edge (diagonal 20 plus
/// the number of adjacent edges), which keeps it symmetric positive definite. Every term is multiplied by the cell area
/// h^2: u'Ku/2 is in J, lambda is a nodal force in N. Unknowns: the lower plate's nodes, then the upper one's.
/// InputError unless n >= 3 and the data are finite, stiffness and mass positive, the gap not negative.
/// (Balajewicz, Amsallem, Farhat, eqs. 21 to 24.)
Scene two_plates(Index n, const PlatesData& data = {});

}  // namespace tact
