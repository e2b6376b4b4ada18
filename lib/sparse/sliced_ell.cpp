#include "tact/lib/sparse/sliced_ell.hpp"

#include <algorithm>
#include <functional>
#include <string_view>
#include <unordered_map>

namespace tact {

SlicedEll::SlicedEll(const SparseMatrix& by_row, const std::vector<Index>& order, const std::vector<Index>& position,
                     bool without_diagonal)
    : rows_(static_cast<Index>(order.size())) {
    struct Entry {
        Index lane, column;
        double value;
    };
    std::vector<Entry> entries;
    std::vector<long> offsets;
    slice_.push_back(0);
    std::vector<double> values;
    std::unordered_multimap<std::size_t, std::size_t> known;  // hash of a slice's values -> where they begin
    const auto place_of = [&](const std::vector<double>& block) {
        const std::string_view bytes(reinterpret_cast<const char*>(block.data()), block.size() * sizeof(double));
        const auto hash = std::hash<std::string_view>{}(bytes);
        const auto [first, last] = known.equal_range(hash);
        for (auto it = first; it != last; ++it)
            if (it->second + block.size() <= value_.size() &&
                std::equal(block.begin(), block.end(), value_.begin() + static_cast<std::ptrdiff_t>(it->second)))
                return it->second;
        const auto place = value_.size();
        value_.insert(value_.end(), block.begin(), block.end());
        known.emplace(hash, place);
        return place;
    };
    for (Index first = 0; first < rows_; first += lanes) {
        entries.clear();
        offsets.clear();
        std::vector<Index> per_lane(lanes, 0);
        for (Index l = 0; l < lanes && first + l < rows_; ++l) {
            const Index row = order[static_cast<std::size_t>(first + l)];
            for (SparseMatrix::InnerIterator it(by_row, row); it; ++it) {
                if (without_diagonal && it.index() == row) continue;
                const Index column = position[static_cast<std::size_t>(it.index())];
                entries.push_back({l, column, it.value()});
                offsets.push_back(column - l);
                ++per_lane[static_cast<std::size_t>(l)];
            }
        }
        std::sort(offsets.begin(), offsets.end());
        offsets.erase(std::unique(offsets.begin(), offsets.end()), offsets.end());
        const auto longest = static_cast<std::size_t>(*std::max_element(per_lane.begin(), per_lane.end()));
        values.clear();
        // A run costs about half of a gather: prefer runs while they are not too many.
        if (offsets.size() <= 2 * longest) {
            for (const long offset : offsets) column_.push_back(static_cast<int>(offset));
            values.resize(offsets.size() * lanes, 0.0);
            for (const Entry& e : entries) {
                const auto slot = static_cast<std::size_t>(
                    std::lower_bound(offsets.begin(), offsets.end(), e.column - e.lane) - offsets.begin());
                values[slot * lanes + static_cast<std::size_t>(e.lane)] += e.value;
            }
        } else {
            std::vector<std::size_t> filled(lanes, 0);
            for (std::size_t k = 0; k < longest; ++k)
                column_.push_back(gathered - static_cast<int>(index_.size() / lanes + k));
            const auto group = index_.size();
            index_.resize(group + longest * lanes, 0);
            values.resize(longest * lanes, 0.0);
            for (const Entry& e : entries) {
                const auto lane = static_cast<std::size_t>(e.lane);
                const auto slot = filled[lane]++;
                index_[group + slot * lanes + lane] = static_cast<int>(e.column);
                values[slot * lanes + lane] = e.value;
            }
        }
        slice_.push_back(column_.size());
        values_of_.push_back(place_of(values));
    }
}

void SlicedEll::multiply(const double* x, double* y) const {
    for (Index s = 0; s < slices(); ++s) {
        Lanes sum;
        multiply_slice(s, x, sum);
        store(y + s * lanes, sum);
    }
}

std::vector<int> greedy_colouring(const SparseMatrix& A) {
    std::vector<int> colour(static_cast<std::size_t>(A.cols()), -1);
    std::vector<Index> taken_by;
    for (Index j = 0; j < A.cols(); ++j) {
        for (SparseMatrix::InnerIterator it(A, j); it; ++it) {
            const int c = colour[static_cast<std::size_t>(it.index())];
            if (c >= 0 && it.index() != j) taken_by[static_cast<std::size_t>(c)] = j;
        }
        const auto free = std::find_if(taken_by.begin(), taken_by.end(), [&](Index by) { return by != j; });
        colour[static_cast<std::size_t>(j)] = static_cast<int>(free - taken_by.begin());
        if (free == taken_by.end()) taken_by.push_back(-1);
    }
    return colour;
}

}  // namespace tact
