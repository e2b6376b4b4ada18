// CHOLMOD behind the LinearSolver seam: symmetric positive definite sparse matrices.
#pragma once

#include "../algebra/linear_solver.hpp"
#include "supernodal_factor.hpp"

namespace tact {

/// Supernodal sparse Cholesky factorisation (CHOLMOD; its supernodal part is GPL). A matrix whose diagonal falls into
/// identical contiguous blocks (two equal bodies) is factored once and solved for all blocks together. Bands of up to
/// BandFactor::widest diagonals beside the main one need no library: they get a BandFactor.
/// InputError unless A is square and symmetric; NumericalError "not positive definite" with the column.
class CholmodSolver final : public LinearSolver {
public:
    std::unique_ptr<const Factor> factorize(const Matrix& A) const override;
};

/// A matrix that is `blocks` times the one that the factor is of, one after the other.
std::unique_ptr<const Factor> factor_of_blocks(SupernodalFactor factor, Index blocks);

/// Number of identical contiguous diagonal blocks of A (same pattern and values): 1 if there is no such structure.
Index identical_blocks(const SparseMatrix& A);

}  // namespace tact
