#include "nndsvd.hpp"

#include <algorithm>
#include <cmath>

#include "singular_pairs.hpp"

namespace tact {

NonNegativePair nndsvd(const NonNegativeBlock& X, Index rank) {
    const SingularPairs pairs = leading_singular_pairs(X, rank);
    NonNegativePair start{DenseMatrix::Zero(rank, X.rows()), DenseMatrix::Zero(rank, X.cols())};
    const double largest = pairs.scaled_left.cols() > 0 ? pairs.scaled_left.col(0).norm() : 0;
    for (Index j = 0; j < pairs.right.cols(); ++j) {
        // Below this the pair is rounding, see gram_eigen: a start made of it would only slow the sweeps.
        if (!(pairs.scaled_left.col(j).norm() > 1e-7 * largest)) break;
        const auto left = pairs.scaled_left.col(j).array(), right = pairs.right.col(j).array();
        const double plus = left.max(0).matrix().norm() * right.max(0).matrix().norm();
        const double minus = left.min(0).matrix().norm() * right.min(0).matrix().norm();
        const double sign = plus >= minus ? 1 : -1;
        const Vector w = (sign * left).max(0), h = (sign * right).max(0);
        const double share = std::sqrt(std::max(plus, minus));
        if (w.norm() == 0 || h.norm() == 0) continue;
        start.W_transposed.row(j) = w.transpose() * (share / w.norm());
        start.H_transposed.row(j) = h.transpose() * (share / h.norm());
    }
    return start;
}

}  // namespace tact
