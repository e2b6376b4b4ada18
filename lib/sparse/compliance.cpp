#include "compliance.hpp"

#include <algorithm>

namespace tact {

void Compliance::form(const SparseMatrix& R, Index first, Eigen::Ref<DenseMatrix> S) {
    take_rows(R);
    take_right_hand_sides(first);
    for (Index j = first; j < R.cols(); ++j) S.col(j).head(j + 1).setZero();
    std::vector<std::int32_t> rows;
    for (const Entry& entry : entries_) rows.push_back(entry.row);
    const SupernodalFactor::Reach reach = factor_.reach(rows);
    const std::span<const RightHandSide> all(right_hand_sides_);
    for (std::size_t k = 0; k < all.size(); k += SupernodalFactor::lanes)
        solve(all.subspan(k, std::min<std::size_t>(SupernodalFactor::lanes, all.size() - k)), reach, S);
}

void Compliance::take_rows(const SparseMatrix& R) {
    const Index n = factor_.size();
    entries_.clear();
    start_.assign(1, 0);
    for (Index j = 0; j < R.cols(); ++j) {
        for (SparseMatrix::InnerIterator it(R, j); it; ++it)
            entries_.push_back(
                {static_cast<std::int32_t>(it.row() / n), static_cast<std::int32_t>(it.row() % n), it.value()});
        start_.push_back(entries_.size());
    }
}

void Compliance::take_right_hand_sides(Index first) {
    right_hand_sides_.clear();
    std::vector<Entry> part;
    for (Index j = first; j + 1 < static_cast<Index>(start_.size()); ++j) {
        const std::size_t of_column = right_hand_sides_.size();
        const auto repeated = [&](std::int32_t block) {
            for (std::size_t k = of_column; k < right_hand_sides_.size(); ++k)
                for (const double sign : {1.0, -1.0})
                    if (std::equal(part.begin(), part.end(), right_hand_sides_[k].entries.begin(),
                                   right_hand_sides_[k].entries.end(), [sign](const Entry& a, const Entry& b) {
                                       return a.row == b.row && a.value == sign * b.value;
                                   })) {
                        right_hand_sides_[k].repeats[static_cast<std::size_t>(block)] = sign;
                        return true;
                    }
            return false;
        };
        const auto column = row(j);
        for (auto entry = column.begin(); entry != column.end();) {
            const std::int32_t block = entry->block;
            part.clear();
            for (; entry != column.end() && entry->block == block; ++entry) part.push_back(*entry);
            if (repeated(block)) continue;
            right_hand_sides_.push_back({j, part, std::vector<double>(static_cast<std::size_t>(blocks_), 0.0)});
            right_hand_sides_.back().repeats[static_cast<std::size_t>(block)] = 1;
        }
    }
    // Neighbours in the tree come together: what is zero in all of them is passed over.
    std::stable_sort(right_hand_sides_.begin(), right_hand_sides_.end(),
                     [this](const RightHandSide& a, const RightHandSide& b) {
                         return few_.place(a.entries.front().row) < few_.place(b.entries.front().row);
                     });
}

void Compliance::solve(std::span<const RightHandSide> some, const SupernodalFactor::Reach& reach,
                       Eigen::Ref<DenseMatrix> S) {
    constexpr auto lanes = static_cast<std::size_t>(SupernodalFactor::lanes);
    // repeats[block * lanes + k]: of right-hand side k
    std::vector<double> repeats(static_cast<std::size_t>(blocks_) * lanes, 0.0);
    Index last = 0;
    for (std::size_t k = 0; k < some.size(); ++k) {
        for (const Entry& entry : some[k].entries) few_[entry.row][k] = entry.value;
        for (std::size_t block = 0; block < some[k].repeats.size(); ++block)
            repeats[block * lanes + k] = some[k].repeats[block];
        last = std::max(last, some[k].column);
    }
    factor_.solve(reach, few_);
    for (Index i = 0; i <= last; ++i) {
        double sum[lanes] = {};
        for (const Entry& entry : row(i)) {
            const double* x = few_[entry.row];
            const double* times = repeats.data() + static_cast<std::size_t>(entry.block) * lanes;
            for (std::size_t k = 0; k < lanes; ++k) sum[k] += entry.value * times[k] * x[k];
        }
        for (std::size_t k = 0; k < some.size(); ++k)
            if (i <= some[k].column) S(i, some[k].column) += sum[k];
    }
    factor_.clear(reach, few_);
}

}  // namespace tact
