// Gram matrices and their eigenvectors: the method of snapshots.
#pragma once

#include "../../lib/types.hpp"

namespace tact {

/// X'X, both triangles, in blocks of rows that stay in cache.
DenseMatrix gram(const Eigen::Ref<const DenseMatrix>& X);

/// G = V diag(sigma^2) V', descending. Eigenvalues that rounding made negative count as zero.
struct GramEigen {
    DenseMatrix vectors;
    Vector singular_values;
};
GramEigen gram_eigen(const DenseMatrix& G);

}  // namespace tact
