// What the recipes for dual bases share.
#pragma once

#include <string>
#include <vector>

#include "dual_basis.hpp"
#include "non_negative_block.hpp"

namespace tact {

/// The snapshots without zero rows and columns, after all checks DualBasis promises.
NonNegativeBlock checked_snapshots(const DualBasisInput& input);

/// A result without columns.
DualBasisResult empty_dual_basis(const DualBasisInput& input);

/// Tells progress; false if it is to stop.
bool report(const DualBasisInput& input, double fraction);

/// X'X of these columns of X.
DenseMatrix snapshot_gram(const SparseMatrix& X, const std::vector<Index>& columns);

/// These columns of X at unit length, dense.
DenseMatrix unit_columns(const SparseMatrix& X, const std::vector<Index>& columns);

/// e_i for each of these rows, in their order.
DenseMatrix unit_vectors(Index size, const std::vector<Index>& rows);

/// Empty unless the best `rank` vectors leave more than a tenth of the snapshots' norm.
std::string decay_warning(const NonNegativeBlock& X, Index rank);

}  // namespace tact
