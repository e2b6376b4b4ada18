// Non-negative matrix factorisation: the dual basis.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "../../lib/errors.hpp"
#include "nnmf_updates.hpp"

namespace tact {

/// Starts of numbers in (0, 1) from seed, seed + 1, ...: the one that ends lowest is taken. The same on every machine.
struct RandomStarts {
    std::uint64_t seed = 1;
    int count = 1;
};

struct NnmfOptions {
    NnmfUpdates updates = NnmfUpdates::hierarchical;
    std::optional<RandomStarts> random = std::nullopt;  ///< absent: NNDSVD (Boutsidis, Gallopoulos 2008)
    int max_sweeps = 200;
    double tolerance = 1e-3;  ///< stop when a sweep lowers the residual by less than this fraction of itself
    int inner_sweeps = 2;     ///< updates of a factor per product with X, which is what a sweep costs
    /// After each sweep, with the residual |X - U_lambda V| / |X|; false stops.
    std::function<bool(int sweep, double residual)> observer = nullptr;
};

/// X ~ U_lambda V, both >= 0 (eq. 10, 11).
struct Nnmf {
    DenseMatrix U_lambda;                  ///< m x r, columns of unit length, zero where X has zero rows
    DenseMatrix V;                         ///< r x N, zero where X has zero columns
    std::vector<double> residuals;         ///< |X - U_lambda V|_F / |X|_F after each sweep; never increases
    Outcome outcome = Outcome::converged;  ///< or iteration_limit, or stopped: the factors are those reached
};

/// Alternating updates of the two factors on the rows and columns of X that are not zero. Deterministic. Columns that end
/// as zero are dropped, so r <= rank (r < rank where X has a lower rank). The residual is evaluated by its Gram form and
/// is noise below 1e-8. Multiplicative updates cannot leave zero: their NNDSVD start has its zeros filled with a
/// hundredth of its mean. InputError if X has a negative or NaN entry (named), rank exceeds its number of non-zero
/// columns, or there are no starts.
Nnmf nnmf(const SparseMatrix& X, Index rank, const NnmfOptions& options = {});
Nnmf nnmf(const DenseMatrix& X, Index rank, const NnmfOptions& options = {});

}  // namespace tact
