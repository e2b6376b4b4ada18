#include "supernodal_factor.hpp"

#include <algorithm>
#include <utility>

#include "supernodal_kernels.hpp"

namespace tact {

using namespace supernodal;

template <int columns> void SupernodalFactor::forward(const Supernode& node, double* w) const {
    double* x = w + node.first * columns;
    if (std::all_of(x, x + node.width * columns, [](double entry) { return entry == 0; })) return;
    const double* U = begin_of(values_) + node.values_begin;
    const std::int32_t* rows = rows_.data() + node.rows_begin;
    const Band* band = bands_.data() + node.bands_begin;
    const Band* block_band = block_bands_.data() + node.blocks_begin;
    const DiagonalBlock* block = blocks_.data() + node.blocks_begin;
    for (const DiagonalBlock* end = blocks_.data() + node.blocks_end; block != end; ++block, ++block_band) {
        const Index count = block->first - block_band->first_column;
        if (count == 0) continue;
        const double* from = x + block_band->first_column * columns;
        double* to = x + block->first * columns;
        const auto next = [](int i) { return Index{i}; };
        if (block_band->height == 8)
            subtract_product<8, columns>(U, count, from, to, next);
        else
            subtract_product<4, columns>(U, count, from, to, next);
        U += count * block_band->height;
    }
    for (const Band* end = bands_.data() + node.bands_end; band != end; ++band) {
        const Index count = node.width - band->first_column;
        const double* from = x + band->first_column * columns;
        const auto listed = [rows](int i) { return Index{rows[i]}; };
        if (band->height == 8)
            subtract_product<8, columns>(U, count, from, w, listed);
        else
            subtract_product<4, columns>(U, count, from, w, listed);
        U += count * band->height;
        rows += band->height;
    }
}

template <int columns> void SupernodalFactor::backward(const Supernode& node, double* w, double* sums) const {
    constexpr Index sum_size = numbers_in_sum(columns);
    const double* U = begin_of(values_) + node.values_end;
    const Line* inverse = inverses_.data() + node.inverses_end;
    const std::int32_t* rows = rows_.data() + node.rows_end;
    double* x = w + node.first * columns;
    std::fill_n(sums, (node.width + widest) * sum_size, 0.0);
    for (auto b = node.bands_end; b-- > node.bands_begin;) {
        const Band& band = bands_[static_cast<std::size_t>(b)];
        const Index count = node.width - band.first_column;
        U -= count * band.height;
        rows -= band.height;
        double* to = sums + band.first_column * sum_size;
        const auto listed = [rows](int i) { return Index{rows[i]}; };
        if (band.height == 8)
            add_transposed_product<8, columns>(U, count, w, listed, to);
        else
            add_transposed_product<4, columns>(U, count, w, listed, to);
    }
    for (auto b = node.blocks_end; b-- > node.blocks_begin;) {
        const DiagonalBlock& block = blocks_[static_cast<std::size_t>(b)];
        const Band& block_band = block_bands_[static_cast<std::size_t>(b)];
        double* y = x + block.first * columns;
        inverse -= (block.width * block_band.height + 7) / 8;
        const double* sum = sums + block.first * sum_size;
        if (block_band.height == 8)
            finish_block<8, columns>(inverse->entries, block.width, sum, y);
        else
            finish_block<4, columns>(inverse->entries, block.width, sum, y);
        const Index count = block.first - block_band.first_column;
        U -= count * block_band.height;
        if (count == 0) continue;
        double* to = sums + block_band.first_column * sum_size;
        const auto next = [](int i) { return Index{i}; };
        if (block_band.height == 8)
            add_transposed_product<8, columns>(U, count, y, next, to);
        else
            add_transposed_product<4, columns>(U, count, y, next, to);
    }
}

template <int columns> double* SupernodalFactor::sums() const {
    const auto lines = static_cast<std::size_t>((widest_supernode_ + widest) * numbers_in_sum(columns) + 7) / 8;
    if (sums_.size() < lines) sums_.resize(lines);
    return sums_.front().entries;
}

template <int columns> void SupernodalFactor::solve_chunk(std::span<double* const> x) const {
    // Rows n .. n+7 stand for the rows that fill up bands: they stay zero.
    const auto lines = static_cast<std::size_t>((n_ + widest) * columns + 7) / 8;
    if (work_.size() < lines) work_.resize(lines);
    double* w = work_.front().entries;
    if (x.size() < columns) std::fill_n(w, n_ * columns, 0.0);
    for (Index i = 0; i < n_; ++i) {
        double* to = w + row_of_[static_cast<std::size_t>(i)] * columns;
        for (std::size_t k = 0; k < x.size(); ++k) to[k] = x[k][i];
    }
    std::fill_n(w + n_ * columns, widest * columns, 0.0);
    double* sums = this->sums<columns>();
    for (const Supernode& node : supernodes_) forward<columns>(node, w);
    for (auto node = supernodes_.rbegin(); node != supernodes_.rend(); ++node) backward<columns>(*node, w, sums);
    for (Index i = 0; i < n_; ++i) {
        const double* from = w + row_of_[static_cast<std::size_t>(i)] * columns;
        for (std::size_t k = 0; k < x.size(); ++k) x[k][i] = from[k];
    }
}

void SupernodalFactor::solve(std::span<double* const> columns) const {
    while (!columns.empty()) {
        const auto chunk = columns.first(std::min<std::size_t>(columns.size(), 16));
        columns = columns.subspan(chunk.size());
        if (chunk.size() > 8)
            solve_chunk<16>(chunk);
        else if (chunk.size() > 4)
            solve_chunk<8>(chunk);
        else if (chunk.size() > 2)
            solve_chunk<4>(chunk);
        else if (chunk.size() == 2)
            solve_chunk<2>(chunk);
        else
            solve_chunk<1>(chunk);
    }
}

SupernodalFactor::Reach SupernodalFactor::reach(std::span<const std::int32_t> rows) const {
    std::vector<char> met(supernodes_.size(), 0);
    Reach reach;
    for (const std::int32_t row : rows) {
        const auto after = std::upper_bound(supernodes_.begin(), supernodes_.end(), place(row),
                                            [](std::int32_t at, const Supernode& node) { return at < node.first; });
        for (auto s = static_cast<std::int32_t>(after - supernodes_.begin()) - 1; s >= 0;) {
            const auto k = static_cast<std::size_t>(s);
            if (std::exchange(met[k], 1)) break;
            reach.push_back(s);
            s = supernodes_[k].parent;
        }
    }
    std::sort(reach.begin(), reach.end());
    return reach;
}

void SupernodalFactor::solve(const Reach& reach, FewRows& few) const {
    double* w = few.begin();
    double* sums = this->sums<lanes>();
    const auto node = [this](std::int32_t s) -> const Supernode& { return supernodes_[static_cast<std::size_t>(s)]; };
    for (const std::int32_t s : reach) forward<lanes>(node(s), w);
    for (auto s = reach.rbegin(); s != reach.rend(); ++s) backward<lanes>(node(*s), w, sums);
}

void SupernodalFactor::clear(const Reach& reach, FewRows& few) const {
    const auto zero = [&](Index first, Index count) { std::fill_n(few.begin() + first * lanes, count * lanes, 0.0); };
    for (const std::int32_t s : reach) {
        const Supernode& node = supernodes_[static_cast<std::size_t>(s)];
        zero(node.first, node.width);
    }
    zero(n_, widest);
}

}  // namespace tact
