// CHOLMOD behind the LinearSolver seam: symmetric positive definite sparse matrices.
#pragma once

#include <utility>
#include <vector>

#include "../algebra/linear_solver.hpp"
#include "supernodal_factor.hpp"

namespace tact {

/// Supernodal sparse Cholesky factorisation (CHOLMOD; its supernodal part is GPL). A matrix whose diagonal falls into
/// identical contiguous blocks (two equal bodies) is factored once and solved for all blocks together. Bands of up to
/// BandFactor::widest diagonals beside the main one need no library: they get a BandFactor.
/// The order is AMD's, or nested dissection of the nodes (METIS) where AMD's factor costs more than 3e9 operations and the
/// other one fewer: in 3-D 3 to 13 times fewer.
/// InputError unless A is square and symmetric; NumericalError "not positive definite" with the column.
class CholmodSolver final : public LinearSolver {
public:
    CholmodSolver() = default;
    /// The unknowns of `last` come last in the order of elimination: Factor::compliance on them then is cheap, for a third
    /// more operations in the factor.
    explicit CholmodSolver(std::vector<Index> last) : last_(std::move(last)) {}
    std::unique_ptr<const Factor> factorize(const Matrix& A) const override;

private:
    std::vector<Index> last_;
};

/// A matrix that is `blocks` times the one that the factor is of, one after the other.
std::unique_ptr<const Factor> factor_of_blocks(SupernodalFactor factor, Index blocks);

/// Number of identical contiguous diagonal blocks of A (same pattern and values): 1 if there is no such structure.
Index identical_blocks(const SparseMatrix& A);

}  // namespace tact
