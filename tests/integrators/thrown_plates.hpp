// Two plates without load, the lower one thrown at the upper one; full and reduced.
#pragma once

#include <Eigen/QR>
#include <cmath>
#include <numbers>

#include "../../lib/scenes/plates.hpp"
#include "../../rom/model/reduce.hpp"

namespace tact::testing {

/// n x n nodes each.
inline ContactProblem thrown_plates(Index n) {
    const Scene scene = two_plates(n, {.pressure = 0});
    ContactProblem problem = scene.problem;
    problem.f = Vector(Vector::Zero(problem.size()));
    for (Index i = 0; i < n * n; ++i)
        problem.v0[i] =
            8 * std::sin(std::numbers::pi * scene.mesh.x(i)) * std::sin(std::numbers::pi * scene.mesh.y(i));
    return problem;
}

/// On p sine modes of the upper and lower plate, and p bumps over the contact nodes: no training needed.
inline ContactProblem reduced_thrown_plates(Index n, Index p) {
    const Scene scene = two_plates(n, {.pressure = 0});
    const ContactProblem full = thrown_plates(n);
    const Index nodes = n * n;
    ReducedBasis basis{DenseMatrix::Zero(2 * nodes, 2 * p), DenseMatrix::Zero(nodes, p)};
    for (Index k = 0; k < p; ++k)
        for (Index i = 0; i < nodes; ++i) {
            const double x = scene.mesh.x(i), y = scene.mesh.y(i), a = static_cast<double>(1 + k % 4),
                         b = static_cast<double>(1 + k / 4);
            const double mode = std::sin(a * std::numbers::pi * x) * std::sin(b * std::numbers::pi * y);
            basis.U(i, k) = mode;
            basis.U(nodes + i, p + k) = mode;
            const double dx = x - a / 5, dy = y - b / 4;
            basis.U_lambda(i, k) = std::exp(-60 * (dx * dx + dy * dy));
        }
    return reduce(full, modal_basis(full, basis));
}

}  // namespace tact::testing
