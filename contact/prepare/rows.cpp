#include "rows.hpp"

#include <numeric>
#include <vector>

namespace tact {

ConstraintRows::ConstraintRows(const Matrix& B) {
    if (const Vector* diagonal = B.diagonal_entries(); diagonal && (diagonal->array() != 0).all()) {
        start_.resize(static_cast<std::size_t>(B.rows()) + 1);
        std::iota(start_.begin(), start_.end(), std::size_t{0});
        column_.resize(start_.size());
        std::iota(column_.begin(), column_.end(), 0);
        weight_.assign(diagonal->begin(), diagonal->end());
        weight_.push_back(0);
        return;
    }
    const SparseMatrix Bt = B.to_sparse().transpose();
    start_.reserve(static_cast<std::size_t>(B.rows()) + 1);
    start_.push_back(0);
    std::vector<char> seen(static_cast<std::size_t>(B.cols()), 0);
    for (Index i = 0; i < Bt.outerSize(); ++i) {
        for (SparseMatrix::InnerIterator it(Bt, i); it; ++it) {
            if (it.value() == 0) continue;
            column_.push_back(static_cast<int>(it.index()));
            weight_.push_back(it.value());
            char& used = seen[static_cast<std::size_t>(it.index())];
            if (used) disjoint_ = false;
            used = 1;
        }
        if (column_.size() == start_.back()) disjoint_ = false;
        start_.push_back(column_.size());
    }
    // spans of the empty last row must have an address to point at
    column_.push_back(0);
    weight_.push_back(0);
}

bool ConstraintRows::bounds() const {
    for (Index i = 0; i < rows(); ++i)
        if (columns(i).size() != 1) return false;
    return true;
}

SparseMatrix scaled_rows(const Matrix& B, const Vector& unit) {
    SparseMatrix Bt = B.to_sparse().transpose();
    for (Index i = 0; i < Bt.outerSize(); ++i)
        for (SparseMatrix::InnerIterator it(Bt, i); it; ++it) it.valueRef() *= unit[it.row()];
    Bt.prune([](Index, Index, double value) { return value != 0; });
    return Bt;
}

std::vector<Index> unknowns_in_rows(const Matrix& B, Index most) {
    const SparseMatrix rows = B.to_sparse();
    std::vector<char> seen(static_cast<std::size_t>(B.cols()), 0);
    for (Index k = 0; k < rows.outerSize(); ++k)
        for (SparseMatrix::InnerIterator it(rows, k); it; ++it) seen[static_cast<std::size_t>(it.col())] = 1;
    std::vector<Index> unknowns;
    for (Index j = 0; j < B.cols(); ++j)
        if (seen[static_cast<std::size_t>(j)]) unknowns.push_back(j);
    return static_cast<Index>(unknowns.size()) <= most ? unknowns : std::vector<Index>{};
}

}  // namespace tact
