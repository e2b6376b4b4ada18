// Proper orthogonal decomposition of a snapshot matrix.
#pragma once

#include <optional>

#include "tact/lib/matrix.hpp"

namespace tact {

struct PodOptions {
    Index rank = 0;        ///< modes wanted; 0: all that are resolved
    double tolerance = 0;  ///< drop singular values up to this fraction of the largest
    /// n x n, symmetric positive definite: modes are orthonormal in it and singular values measured with it. Absent: identity.
    std::optional<Matrix> inner_product = std::nullopt;
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
/// to about 1e-16 (sigma_1/sigma)^2 of themselves. Returns fewer modes than wanted where X has a lower numerical rank.
/// InputError if rank exceeds the number of snapshots, or on a NaN.
Pod pod(const DenseMatrix& X, const PodOptions& options = {});

/// The columns of a nearly orthonormal X orthonormal in W, by Cholesky QR twice; their span and order stay. InputError if
/// W is not positive definite on them.
DenseMatrix orthonormal_in(const Matrix& W, DenseMatrix X);

}  // namespace tact
