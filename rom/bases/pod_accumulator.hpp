// POD of more snapshots than are worth keeping.
#pragma once

#include "pod.hpp"

namespace tact {

struct PodAccumulatorOptions {
    double tolerance = 1e-7;  ///< directions below this fraction of the largest singular value are forgotten
    Index max_vectors = 250;  ///< and so are those beyond this many: keep it well above the modes wanted
    /// As PodOptions::inner_product; the norm in `forgotten` is then that one's too.
    std::optional<Matrix> inner_product = std::nullopt;
};

/// POD of snapshots that arrive in blocks. Holds the leading left singular vectors of all snapshots so far, scaled by
/// their singular values, and merges each block into them by Gram matrices; so memory is n x 2 max_vectors beside the block.
/// What is forgotten at each merge bounds the difference to the POD of all snapshots (Himpe, Leibner, Rave, SIAM J. Sci. Comput. 40, 2018).
class PodAccumulator {
public:
    explicit PodAccumulator(PodAccumulatorOptions options = {}) : options_(std::move(options)) {}

    /// InputError if the number of rows differs from that of earlier blocks or of the inner product, or on a NaN.
    void add(const Eigen::Ref<const DenseMatrix>& block);

    /// Of all blocks added, forgotten directions included.
    Index snapshots() const { return snapshots_; }
    Index vectors() const { return scaled_modes_.cols(); }
    const Vector& singular_values() const { return singular_values_; }
    /// Sum of the squared singular values forgotten so far: |X - its projection|_F^2 is at most about this.
    double forgotten() const { return forgotten_; }

    /// The first p modes, orthonormal, signs fixed; fewer if fewer are held. InputError if p exceeds the number of
    /// snapshots.
    Pod modes(Index p) const;
    /// What is held of X: n x vectors(), U diag(singular_values()).
    const DenseMatrix& scaled_modes() const { return scaled_modes_; }
    const std::optional<Matrix>& inner_product() const { return options_.inner_product; }
    /// How many singular values exceed this fraction of the largest.
    Index above(double fraction) const;

    template <class Archive> void serialize(Archive& archive) {
        archive(scaled_modes_, singular_values_, snapshots_, forgotten_);
    }

private:
    void merge(const Eigen::Ref<const DenseMatrix>& block);

    PodAccumulatorOptions options_;
    DenseMatrix scaled_modes_;  // n x k: U diag(singular_values_)
    Vector singular_values_;
    Index snapshots_ = 0;
    double forgotten_ = 0;
};

}  // namespace tact
