// A membrane under a stamp that moves slowly: equilibrium after equilibrium.
#pragma once

#include "mesh.hpp"

namespace tact {

/// Dimensionless: tension 1, the unit square.
struct PressedMembraneData {
    double radius = 0.25;     ///< of curvature of the stamp's bottom
    double clearance = 0.02;  ///< between its lowest point and the flat membrane at first
    double travel = 0.12;     ///< how far down it goes
    double pressure = 0.5;    ///< from below, at the end
    double duration = 1;      ///< of one way down and up again
};

/// -lap u = pressure t/duration + B' lambda, u = 0 at the edges, without M and D, under the stamp
///   u <= clearance - travel (1 - cos(2 pi t/duration))/2 + ((x - .5)^2 + (y - .5)^2)/(2 radius),
/// so B = -I, and lambda >= 0 pushes down. Load and gap are one and two modes in time. Finite element scaling as in
/// `membrane`, on n x n interior nodes. InputError unless n >= 3 and the data are finite and, but for the pressure, positive.
Scene pressed_membrane(Index n, const PressedMembraneData& data = {});

}  // namespace tact
