// Unknowns that, held, leave nothing soft: three ways to find them.
#pragma once

#include <vector>

#include "../../lib/problem/matrix.hpp"

namespace tact {

/// Indices, rising, of those unknowns that a Cholesky factor with complete pivoting leaves at the end with pivots of at most
/// `soft`. A is symmetric, positive semidefinite; its diagonal is 1 or 0. (N. J. Higham, Analysis of the Cholesky
/// decomposition of a semi-definite matrix, in: Reliable Numerical Computation, 1990)
std::vector<Index> softest_pivots(DenseMatrix A, double soft);

/// Unknowns whose diagonal entry is zero.
std::vector<Index> without_stiffness(const Matrix& A);

/// The same, and about 24 unknowns of each part of A's graph, whole nodes far from one another: held at them a body has no
/// rigid motion left unless it is a mechanism. None of these where the graph has more than 8 parts. A: sparse.
std::vector<Index> unknowns_far_apart(const Matrix& A);

}  // namespace tact
