// A membrane over a ball, whose exact solution is known: the measure of the static discretisation.
#pragma once

#include "mesh.hpp"

namespace tact {

/// -lap u = lambda, u >= psi on (-2, 2)^2 without load, u = radial_obstacle_exact on the boundary; psi = sqrt(1 - r^2), the
/// upper half of the unit ball, for r^2 <= .9, continued by its tangent in r^2, which the membrane does not touch.
///
/// Five-point stencil on n x n interior nodes in finite element scaling, as MembraneFamily: K = (4, -1, -1, -1, -1), f holds
/// the values on the boundary, lambda is a nodal force. The mesh is the unit square: x = 4 mesh.x(node) - 2; its values
/// between the outermost nodes and the boundary (where u is not zero) are not those of the solution.
/// InputError unless n >= 3. Example 9 of PETSc's SNES tutorials (E. Bueler, PETSc for Partial Differential Equations).
Scene radial_obstacle(Index n);

/// sqrt(1 - r^2) for r <= a = .69796..., -A ln r + B beyond, where the two meet with one slope.
double radial_obstacle_exact(double x, double y);

}  // namespace tact
