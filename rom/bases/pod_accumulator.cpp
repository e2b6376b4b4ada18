#include "pod_accumulator.hpp"

#include <algorithm>
#include <string>

#include "../../lib/errors.hpp"
#include "../model/orthonormal.hpp"
#include "gram.hpp"

namespace tact {

void PodAccumulator::add(const Eigen::Ref<const DenseMatrix>& block) {
    if (snapshots_ > 0 && block.rows() != scaled_modes_.rows())
        throw InputError("PodAccumulator: block has " + std::to_string(block.rows()) + " rows, expected " +
                         std::to_string(scaled_modes_.rows()));
    if (options_.inner_product && options_.inner_product->rows() != block.rows())
        throw InputError("PodAccumulator: block has " + std::to_string(block.rows()) + " rows, expected " +
                         std::to_string(options_.inner_product->rows()) + " as the inner product");
    if (!block.allFinite())
        throw InputError("PodAccumulator: block has a NaN or infinite entry, expected finite entries");
    snapshots_ += block.cols();
    // A merge costs n (added + held)^2: wide blocks in pieces of about the size that costs least per snapshot.
    constexpr Index piece = 400;
    const Index pieces = (block.cols() + piece - 1) / piece;
    for (Index k = 0; k < pieces; ++k) {
        const Index from = block.cols() * k / pieces, to = block.cols() * (k + 1) / pieces;
        merge(block.middleCols(from, to - from));
    }
}

void PodAccumulator::merge(const Eigen::Ref<const DenseMatrix>& block) {
    const Index n = block.rows(), held = vectors(), added = block.cols();

    // Gram matrix of [held, block]; the held vectors are orthogonal, so its first block is known.
    DenseMatrix G(held + added, held + added);
    G.topLeftCorner(held, held) = singular_values_.cwiseAbs2().asDiagonal();
    DenseMatrix weighted;
    if (options_.inner_product) {
        weighted = options_.inner_product->times(block);
        G.bottomRightCorner(added, added).noalias() = block.transpose() * weighted;
    } else {
        G.bottomRightCorner(added, added) = gram(block);
    }
    if (held > 0) {
        if (options_.inner_product)
            G.topRightCorner(held, added).noalias() = scaled_modes_.transpose() * weighted;
        else
            G.topRightCorner(held, added).noalias() = scaled_modes_.transpose() * block;
        G.bottomLeftCorner(added, held) = G.topRightCorner(held, added).transpose();
    }
    const GramEigen eigen = gram_eigen(G);
    const Vector& sigma = eigen.singular_values;
    Index kept = 0;
    while (kept < std::min(options_.max_vectors, sigma.size()) && sigma[kept] > options_.tolerance * sigma[0]) ++kept;
    forgotten_ += sigma.tail(sigma.size() - kept).squaredNorm();

    // Row block by row block: the panel stays in cache.
    constexpr Index block_rows = 512;
    const auto turn_held = eigen.vectors.topLeftCorner(held, kept),
               turn_added = eigen.vectors.bottomLeftCorner(added, kept);
    DenseMatrix merged(n, kept);
    for (Index i = 0; i < n; i += block_rows) {
        const Index rows = std::min(block_rows, n - i);
        merged.middleRows(i, rows).noalias() = block.middleRows(i, rows) * turn_added;
        if (held > 0) merged.middleRows(i, rows).noalias() += scaled_modes_.middleRows(i, rows) * turn_held;
    }
    scaled_modes_ = std::move(merged);
    singular_values_ = sigma.head(kept);
}

Pod PodAccumulator::modes(Index p) const {
    if (p < 0 || p > snapshots_)
        throw InputError("PodAccumulator: p is " + std::to_string(p) +
                         ", expected at most the number of snapshots, " + std::to_string(snapshots_));
    const Index r = std::min(p, vectors());
    Pod result{scaled_modes_.leftCols(r), singular_values_.head(r)};
    if (options_.inner_product)
        result.modes = orthonormal_in(*options_.inner_product,
                                      result.modes * result.singular_values.cwiseInverse().asDiagonal());
    else
        result.modes = orthonormal_columns(std::move(result.modes), 0);
    fix_signs(result.modes);
    return result;
}

Index PodAccumulator::above(double fraction) const {
    return singular_values_.size() == 0 ? 0 : (singular_values_.array() > fraction * singular_values_[0]).count();
}

}  // namespace tact
