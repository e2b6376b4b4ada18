// Stiff linear systems with a few constraints, drawn at random: what energy laws are tried on.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <cmath>
#include <random>

#include "../../lib/problem/contact_problem.hpp"

namespace tact::testing {

/// n x n dense M and K with frequencies h omega from 1e-2 to 30 for h = 1, m dense rows, c so that u0 is admissible,
/// some rows closed at the start, no load.
inline ContactProblem random_stiff_system(std::mt19937_64& random) {
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> uniform;
    const Index n = std::uniform_int_distribution<Index>(1, 8)(random);
    const Index m = std::uniform_int_distribution<Index>(1, 5)(random);
    const auto draw = [&](Index rows, Index cols) {
        return DenseMatrix(DenseMatrix::NullaryExpr(rows, cols, [&] { return normal(random); }));
    };
    // M = X'X + 1, K = M^(1/2) Q diag(omega^2) Q' M^(1/2), through the Cholesky factor of M
    const DenseMatrix X = draw(n, n);
    const DenseMatrix M = X.transpose() * X + DenseMatrix::Identity(n, n);
    const DenseMatrix L = M.llt().matrixL();
    const DenseMatrix Q = draw(n, n).householderQr().householderQ();
    const Vector omega =
        Vector::NullaryExpr(n, [&] { return std::pow(10.0, -2 + uniform(random) * (2 + std::log10(30.0))); });
    const DenseMatrix root = L * Q;
    const DenseMatrix K = root * omega.cwiseAbs2().asDiagonal() * root.transpose();
    ContactProblem p;
    p.M = Matrix(DenseMatrix(0.5 * (M + M.transpose())));
    p.K = Matrix(DenseMatrix(0.5 * (K + K.transpose())));
    const DenseMatrix B = draw(m, n);
    p.B = Matrix(B);
    p.f = Vector(Vector::Zero(n));
    p.u0 = draw(n, 1);
    p.v0 = draw(n, 1);
    const Vector gap = Vector::NullaryExpr(
        m, [&] { return uniform(random) < 0.3 ? 0.0 : std::abs(normal(random)) * uniform(random); });
    p.c = Vector(B * p.u0 - gap);
    return p;
}

}  // namespace tact::testing
