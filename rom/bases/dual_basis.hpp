// Dual bases: one function type, and the recipes for it.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "../../lib/errors.hpp"
#include "../model/reduced_basis.hpp"
#include "nnmf.hpp"

namespace tact {

/// What a dual basis is made of.
struct DualBasisInput {
    const SparseMatrix& snapshots;  ///< m x N multipliers, >= 0
    const Matrix& B;                ///< m x n
    const DenseMatrix& U;           ///< n x p, the primal basis in modal coordinates
    Index size;                     ///< p_lambda wanted; fewer are given where there are fewer
    /// How far it is, 0 to 1; false stops. May be empty.
    std::function<bool(double fraction)> progress = nullptr;
};

struct [[nodiscard]] DualBasisResult {
    DenseMatrix U_lambda;  ///< m x r
    DualSigns signs = DualSigns::non_negative;
    Outcome outcome = Outcome::converged;  ///< of an iteration; `stopped` by progress
    std::vector<double> residuals;         ///< |X - its best fit|_F / |X|_F as the iteration went, where there is one
    std::string warning;                   ///< for a person, or empty: the snapshots compress badly
};

/// Makes U_lambda. Deterministic. Rows without a positive snapshot stay zero; without snapshots, or asked for none, U_lambda has no
/// columns. InputError for a negative or NaN snapshot (named), shapes that do not fit, or size < 0.
using DualBasis = std::function<DualBasisResult(const DualBasisInput&)>;

/// The snapshots themselves, at unit length; where there are more than `size`, that many evenly spaced ones.
DualBasis snapshot_cone();

/// Balajewicz, Amsallem, Farhat, section 4.3.
DualBasis nnmf_basis(NnmfOptions options = {});

/// The snapshots chosen one by one, each the farthest from the cone of those before it (Benaceur, Ern, Ehrlacher, Int. J.
/// Numer. Methods Eng. 121, 2020); until the farthest is within `tolerance` of the longest. Distances are resolved to 1e-7.
DualBasis cone_projected_greedy(double tolerance = 0);

/// Exchanges of a selected row for a touched one that is not, kept where the error falls.
struct RowSwaps {
    int tries = 0;
    std::uint64_t seed = 1;  ///< of the pairs tried: the same rows for the same seed
    /// What is to fall: the error of contact at these rows, such as a TrainingError.
    std::function<double(const DenseMatrix& U, const std::vector<Index>& rows)> error = nullptr;
};

/// Contact at single rows of B: unit vectors at the first pivots of a column-pivoted QR factorisation of (B U)' over the touched rows,
/// beyond their rank filled with evenly spaced ones. Rows that U cannot tell apart, as a mirrored pair in a
/// symmetric scene, count once. With tries, some of them are then exchanged; the residuals are the errors kept.
DualBasis selected_rows(RowSwaps swaps = {});

/// Contact at every touched row, whatever size is asked: no compression.
DualBasis touched_rows();

/// Left singular vectors of the snapshots, of either sign: the paper's counter-example, not a basis to work with.
DualBasis singular_vectors();

}  // namespace tact
