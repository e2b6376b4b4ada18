// Proper orthogonal decomposition of a snapshot matrix.
#pragma once

#include <cstdint>
#include <optional>

#include "../../lib/problem/matrix.hpp"

namespace tact {

/// The randomised range finder (Halko, Martinsson, Tropp, SIAM Rev. 53, 2011, algorithms 4.4 and 5.1): X is met in
/// 2 + 2 power_iterations products with rank + oversampling vectors.
struct RandomisedSketch {
    Index oversampling = 10;  ///< Gaussian vectors beside the modes wanted
    /// Each takes what the other singular values add to the error down by another (sigma_r+1/sigma_r)^2; 0: enough where
    /// they fall fast.
    int power_iterations = 1;
    std::uint64_t seed = 1;  ///< the same bits for the same seed
};

struct PodOptions {
    Index rank = 0;        ///< modes wanted; 0: all that are resolved
    double tolerance = 0;  ///< drop singular values up to this fraction of the largest
    /// n x n, symmetric positive definite: modes are orthonormal in it and singular values measured with it. Absent: identity.
    std::optional<Matrix> inner_product = std::nullopt;
    /// For many more rows and columns than modes: an approximate POD. With rank 0 the sketch is widened until it resolves
    /// `tolerance`. Where it would be as wide as X, X is decomposed without one.
    std::optional<RandomisedSketch> sketch = std::nullopt;
};

/// The best approximation of X of its rank (eq. 8): X ~ modes diag(singular_values) V'.
struct Pod {
    DenseMatrix modes;       ///< n x r, orthonormal, largest entry of each positive
    Vector singular_values;  ///< r, descending
};

/// A matrix of at most this many rows or columns is decomposed by SVD, a larger one by the method of snapshots.
inline constexpr Index pod_svd_size = 64;
/// What the method of snapshots resolves: it squares the singular values, so that those below this fraction of the
/// largest drown in rounding; it drops them.
inline constexpr double pod_snapshots_resolution = 1e-7;

/// X: n x N snapshots. Small or with few columns: SVD, exact to rounding, resolving 1e-14 of the largest singular value.
/// Else the eigenvectors of the Gram matrix of its shorter side, orthonormalised again; singular values are then good
/// to about 1e-16 (sigma_1/sigma)^2 of themselves. With a sketch: the SVD of X projected on the sketch's range, resolving
/// 1e-12; |X - its projection on r modes| is, on average over seeds, at most sigma_r+1 and
/// ((1 + (r/(k-1))^1/2) sigma_r+1^s + e (r+k)^1/2/k (sum of sigma_j^2s, j > r)^1/2)^(1/s) together, k oversampling,
/// s = 1 + 2 power_iterations (their corollary 10.10). Returns fewer modes than wanted where X has a lower numerical rank.
/// InputError if rank exceeds the number of snapshots, or on a NaN.
Pod pod(const DenseMatrix& X, const PodOptions& options = {});

/// The columns of a nearly orthonormal X orthonormal in W, by Cholesky QR twice; their span and order stay. InputError if
/// W is not positive definite on them.
DenseMatrix orthonormal_in(const Matrix& W, DenseMatrix X);

}  // namespace tact
