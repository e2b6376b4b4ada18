#include "tact/contact/rows.hpp"

namespace tact {

ConstraintRows::ConstraintRows(const Matrix& B) {
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

}  // namespace tact
