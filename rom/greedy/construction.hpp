// What bases are made of by default, and by the paper's method.
#pragma once

#include "greedy.hpp"

namespace tact {

/// How both bases are made and what contact the reduced problems are marched with. Chosen by measurement: docs/results/bases.md.
struct Construction {
    Compression compression = Compression::pod_and_dual_basis;
    std::function<BasisSizes(int samples)> sizes;
    DualBasis dual_basis;
    double compliance = 0;  ///< of the reduced contact solver (DenseContactOptions::compliance); 0 in statics

    /// These options with this construction.
    TrainingOptions applied_to(TrainingOptions options) const;
};

/// Contact at selected rows, one for two modes, with a compliance of .3: in marches the error falls with the modes, the
/// penetration with the rows. p = p_final (N / samples_final) in integers, at least 1.
Construction march_construction(Index p_final, int samples_final);

/// Contact at selected rows, two for each mode, without compliance.
Construction static_construction(Index p_final, int samples_final);

/// Balajewicz, Amsallem, Farhat: in marches POD and NNMF of equal size, 2 to p_final; in statics the snapshots themselves.
Construction paper_march_construction(Index p_final, int samples_final);
Construction paper_static_construction();

}  // namespace tact
