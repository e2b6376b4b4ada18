#include "orthonormal.hpp"

#include <algorithm>
#include <cmath>

namespace tact {
namespace {

constexpr Index block_columns = 16;  // a panel of 40,000 rows then stays near the cache, and the rest is gemm

/// Gram-Schmidt inside columns [first, last) of X, dropping the dependent ones; returns the new end. `lengths` are
/// what each column's remainder is measured against.
Index orthonormalise_panel(DenseMatrix& X, Index first, Index last, const Vector& lengths, double tolerance) {
    Index kept = first;
    for (Index j = first; j < last; ++j) {
        if (kept != j) X.col(kept) = X.col(j);
        auto column = X.col(kept);
        const auto before = X.middleCols(first, kept - first);
        for (int pass = 0; pass < 2 && kept > first; ++pass) {
            const Vector overlap = before.transpose() * column;
            column.noalias() -= before * overlap;
        }
        const double length = column.norm();
        if (!(length > tolerance * lengths[j - first]) || length == 0) continue;
        column /= length;
        ++kept;
    }
    return kept;
}

}  // namespace

DenseMatrix orthonormal_columns(DenseMatrix X, double tolerance) {
    Index kept = 0;
    DenseMatrix overlap;
    const auto remove_earlier = [&](Index from, Index count) {
        if (kept == 0) return;
        overlap.noalias() = X.leftCols(kept).transpose() * X.middleCols(from, count);
        X.middleCols(from, count).noalias() -= X.leftCols(kept) * overlap;
    };
    for (Index from = 0; from < X.cols(); from += block_columns) {
        const Index count = std::min(block_columns, X.cols() - from);
        const Vector lengths = X.middleCols(from, count).colwise().norm();
        remove_earlier(from, count);
        const Index end = orthonormalise_panel(X, from, from + count, lengths, tolerance);
        // Columns that nearly depended on earlier ones are only orthogonal to them relative to their old length.
        remove_earlier(from, end - from);
        const Index last = orthonormalise_panel(X, from, end, Vector::Ones(end - from), 0);
        if (kept != from) X.middleCols(kept, last - from) = X.middleCols(from, last - from).eval();
        kept += last - from;
    }
    X.conservativeResize(Eigen::NoChange, kept);
    return X;
}

void fix_signs(DenseMatrix& columns) {
    for (Index j = 0; j < columns.cols(); ++j) {
        auto column = columns.col(j);
        const double largest = column.size() == 0 ? 0 : column.cwiseAbs().maxCoeff();
        for (Index i = 0; i < column.size(); ++i) {
            if (std::abs(column[i]) < (1 - 1e-8) * largest) continue;
            if (column[i] < 0) column *= -1;
            break;
        }
    }
}

}  // namespace tact
