// Both bases from what full runs have left.
#pragma once

#include "dual_basis.hpp"
#include "primal_basis.hpp"
#include "snapshots.hpp"
#include "supremizers.hpp"

namespace tact {

struct BasisSizes {
    Index p = 0;
    Index p_lambda = 0;
};

struct BasisRecipe {
    BasisSizes sizes;           ///< p must not exceed the number of snapshots; p_lambda is lowered to what there is
    double pod_tolerance = 0;   ///< modes up to this fraction of the largest singular value are left out of U
    PrimalOptions primal = {};  ///< what is held is beside the p modes
    DualBasis dual_basis = nnmf_basis();
    SupremizerOptions supremizers;  ///< the last modes of U make way for them
};

struct [[nodiscard]] CompressedBasis {
    ReducedBasis basis;                    ///< modal; no columns where all snapshots are zero
    Outcome outcome = Outcome::converged;  ///< `stopped` by progress; the basis is then not to be used
    std::vector<double> residuals;         ///< of the dual basis
    std::string warning;                   ///< of the dual basis, or empty
    double seconds_pod = 0, seconds_dual = 0, seconds_projection = 0;
};

/// The primal basis of `primal`, the dual basis of `dual`, supremizers for it, in modal coordinates of `problem`, whose M, D, K
/// and B alone are read. `progress` is the dual basis'. InputError for p < 1, p_lambda < 0 or p beyond the snapshots.
CompressedBasis compressed_basis(const ContactProblem& problem, const PodAccumulator& primal,
                                 const DualSnapshots& dual, const BasisRecipe& recipe,
                                 std::function<bool(double fraction)> progress = nullptr);

}  // namespace tact
