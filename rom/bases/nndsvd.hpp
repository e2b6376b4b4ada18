// The start of a non-negative factorisation.
#pragma once

#include "non_negative_block.hpp"

namespace tact {

/// X ~ W H', both >= 0.
struct NonNegativePair {
    DenseMatrix W_transposed;  ///< rank x rows
    DenseMatrix H_transposed;  ///< rank x columns
};

/// NNDSVD: from each leading singular pair of X >= 0 the larger of its positive and negative parts (Boutsidis,
/// Gallopoulos, Pattern Recognition 41, 2008). Vectors beyond the numerical rank are zero. Deterministic: large X is
/// decomposed by subspace iteration from a fixed start, which is as good as needed for a start.
NonNegativePair nndsvd(const NonNegativeBlock& X, Index rank);

}  // namespace tact
