// The leading singular triples of snapshots.
#pragma once

#include "non_negative_block.hpp"

namespace tact {

/// Columns sigma_j u_j and v_j of the leading singular triples, descending.
struct SingularPairs {
    DenseMatrix scaled_left, right;
};

/// At most `rank` of them. By the Gram matrix up to 400 columns or rows; beyond, by subspace iteration from a fixed start,
/// good for what is well separated. Deterministic.
SingularPairs leading_singular_pairs(const NonNegativeBlock& X, Index rank);

}  // namespace tact
