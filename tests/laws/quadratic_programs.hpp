// Random contact QPs with fixed seeds, and their solution by trying every active set: code shared with no solver.
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <limits>
#include <optional>
#include <random>

#include "../../lib/problem/matrix.hpp"

namespace tact::laws {

enum class Rows { bounds, pairs, general };

struct QuadraticProgram {
    DenseMatrix A, B;
    Vector b, c;
};

inline Vector random_vector(std::mt19937& random, Index n) {
    std::normal_distribution<double> normal;
    Vector v(n);
    for (double& x : v) x = normal(random);
    return v;
}

inline DenseMatrix random_matrix(std::mt19937& random, Index rows, Index cols) {
    return random_vector(random, rows * cols).reshaped(rows, cols);
}

/// Feasible by construction: c lies below B u for some u on every row, so that a strictly convex A has one solution.
/// `condition`: of A, about.
inline QuadraticProgram random_program(std::mt19937& random, Index n, Index m, Rows rows, double condition = 20) {
    QuadraticProgram qp;
    const DenseMatrix Q = Eigen::HouseholderQR<DenseMatrix>(random_matrix(random, n, n)).householderQ();
    const Vector eigenvalues = Vector::LinSpaced(n, 0, std::log(condition)).array().exp();
    qp.A = Q * eigenvalues.asDiagonal() * Q.transpose();
    qp.A = (0.5 * (qp.A + qp.A.transpose())).eval();
    qp.B = DenseMatrix::Zero(m, n);
    if (rows == Rows::general) {
        qp.B = random_matrix(random, m, n);
    } else {
        for (Index i = 0; i < m; ++i) {
            if (rows == Rows::bounds) {
                qp.B(i, i) = 0.5 + std::abs(random_vector(random, 1)[0]);
            } else {
                qp.B(i, 2 * i) = 1;
                qp.B(i, 2 * i + 1) = -0.5;
            }
        }
    }
    qp.b = random_vector(random, n);
    qp.c = qp.B * random_vector(random, n) - random_vector(random, m).cwiseAbs() * 0.1;
    return qp;
}

struct Solution {
    Vector u, lambda;
};

/// Every subset of rows as equalities, by one dense KKT system each; the one that satisfies all conditions.
inline std::optional<Solution> by_enumeration(const QuadraticProgram& qp, double tolerance = 1e-9) {
    const Index n = qp.A.rows(), m = qp.B.rows();
    for (unsigned set = 0; set < (1U << m); ++set) {
        std::vector<Index> active;
        for (Index i = 0; i < m; ++i)
            if (set >> i & 1U) active.push_back(i);
        const Index k = static_cast<Index>(active.size());
        const auto off = [&](Index i) { return qp.c[i] == -std::numeric_limits<double>::infinity(); };
        if (k > n || std::any_of(active.begin(), active.end(), off)) continue;
        DenseMatrix kkt = DenseMatrix::Zero(n + k, n + k);
        Vector rhs(n + k);
        kkt.topLeftCorner(n, n) = qp.A;
        rhs.head(n) = qp.b;
        for (Index j = 0; j < k; ++j) {
            kkt.block(n + j, 0, 1, n) = qp.B.row(active[static_cast<std::size_t>(j)]);
            kkt.block(0, n + j, n, 1) = -qp.B.row(active[static_cast<std::size_t>(j)]).transpose();
            rhs[n + j] = qp.c[active[static_cast<std::size_t>(j)]];
        }
        const Eigen::FullPivLU<DenseMatrix> lu(kkt);
        if (!lu.isInvertible()) continue;
        const Vector x = lu.solve(rhs);
        if (k > 0 && x.tail(k).minCoeff() < -tolerance) continue;
        if (m > 0 && (qp.B * x.head(n) - qp.c).minCoeff() < -tolerance) continue;
        Solution solution{x.head(n), Vector::Zero(m)};
        for (Index j = 0; j < k; ++j) solution.lambda[active[static_cast<std::size_t>(j)]] = x[n + j];
        return solution;
    }
    return std::nullopt;
}

}  // namespace tact::laws
