// A membrane on a bed that stiffens: internal forces that are not linear.
#pragma once

#include "mesh.hpp"

namespace tact {

/// Dimensionless.
struct DuffingMembraneData {
    double bed = 50;         ///< kappa
    double load = -10;       ///< f
    double obstacle = -0.3;  ///< g, the same everywhere
};

/// u_tt = lap u - kappa u^3 + f + lambda on the unit square, u = 0 at the edges, at rest at first, u >= g: a Duffing
/// oscillator at every point. Five-point stencil on n x n interior nodes in finite element scaling, as MembraneFamily; the
/// bed is r(u) = kappa h^2 u^3 node by node. InputError unless n >= 3, kappa >= 0, g <= 0, all finite.
Scene duffing_membrane(Index n, const DuffingMembraneData& data = {});

}  // namespace tact
