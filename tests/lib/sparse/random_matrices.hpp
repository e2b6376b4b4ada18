// Matrices for the tests of the sparse solvers: random with fixed seeds.
#pragma once

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "../../../lib/problem/matrix.hpp"

namespace tact::test {

using Triplets = std::vector<Eigen::Triplet<double, long>>;

inline SparseMatrix assemble(Index n, const Triplets& entries) {
    SparseMatrix A(n, n);
    A.setFromTriplets(entries.begin(), entries.end());
    return A;
}

/// Not symmetric, with a diagonal; about `per_column` other entries a column.
inline SparseMatrix random_sparse(Index n, int per_column, unsigned seed) {
    std::mt19937 generator(seed);
    std::uniform_int_distribution<long> row(0, n - 1);
    std::normal_distribution<double> value;
    Triplets entries;
    for (long j = 0; j < n; ++j) {
        entries.emplace_back(j, j, value(generator));
        for (int k = 0; k < per_column; ++k) entries.emplace_back(row(generator), j, value(generator));
    }
    return assemble(n, entries);
}

/// C C' + shift, C sparse: the smaller the shift, the worse its condition.
inline SparseMatrix random_spd(Index n, int per_column, double shift, unsigned seed) {
    const SparseMatrix C = random_sparse(n, per_column, seed);
    SparseMatrix I(n, n);
    I.setIdentity();
    return SparseMatrix(C * SparseMatrix(C.transpose())) + shift * I;
}

/// D A D with diagonal entries of D between 1 and 10^decades.
inline SparseMatrix badly_scaled(const SparseMatrix& A, double decades, unsigned seed) {
    std::mt19937 generator(seed);
    std::uniform_real_distribution<double> exponent(0, decades);
    Vector d(A.rows());
    for (double& x : d) x = std::pow(10., exponent(generator));
    return d.asDiagonal() * A * d.asDiagonal();
}

/// The five-point Laplacian on n x n nodes to a power.
inline SparseMatrix laplacian(Index n, int power = 1) {
    Triplets entries;
    for (long j = 0; j < n; ++j)
        for (long i = 0; i < n; ++i) {
            const long node = i + n * j;
            entries.emplace_back(node, node, 4.);
            if (i > 0) entries.emplace_back(node, node - 1, -1.);
            if (i + 1 < n) entries.emplace_back(node, node + 1, -1.);
            if (j > 0) entries.emplace_back(node, node - n, -1.);
            if (j + 1 < n) entries.emplace_back(node, node + n, -1.);
        }
    const SparseMatrix L = assemble(n * n, entries);
    SparseMatrix result = L;
    for (int k = 1; k < power; ++k) result = SparseMatrix(result * L);
    return result;
}

inline SparseMatrix repeated(const SparseMatrix& A, Index times) {
    Triplets entries;
    for (Index t = 0; t < times; ++t)
        for (Index j = 0; j < A.cols(); ++j)
            for (SparseMatrix::InnerIterator it(A, j); it; ++it)
                entries.emplace_back(t * A.rows() + it.row(), t * A.cols() + it.col(), it.value());
    return assemble(A.rows() * times, entries);
}

inline DenseMatrix random_columns(Index n, Index columns, unsigned seed) {
    std::mt19937 generator(seed);
    std::normal_distribution<double> value;
    DenseMatrix B(n, columns);
    for (double& x : B.reshaped()) x = value(generator);
    return B;
}

/// max_j |b_j - A x_j| / (|A| |x_j| + |b_j|) in the maximum norm: how far A and b would have to move for x to be exact.
inline double backward_error(const SparseMatrix& A, const DenseMatrix& X, const DenseMatrix& B) {
    const double norm = (A.cwiseAbs() * Vector::Ones(A.cols())).maxCoeff();
    const DenseMatrix R = B - A * X;
    double worst = 0;
    for (Index j = 0; j < X.cols(); ++j) {
        const double scale = norm * X.col(j).lpNorm<Eigen::Infinity>() + B.col(j).lpNorm<Eigen::Infinity>();
        worst = std::max(worst, R.col(j).lpNorm<Eigen::Infinity>() / scale);
    }
    return worst;
}

template <class Solve> std::string message_of(const Solve& solve) {
    try {
        solve();
    } catch (const std::exception& error) {
        return error.what();
    }
    return "nothing was thrown";
}

}  // namespace tact::test
