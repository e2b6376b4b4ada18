// How a SupernodalFactor is made from a Cholesky factor.
#include <algorithm>
#include <numeric>

#include "supernodal_factor.hpp"

namespace tact {
namespace {

/// On the rows of |T^-1| |T|, T the triangle of a diagonal block. Up to here its inverse costs nothing that shows: the
/// backward error is 1e-15 at any condition of A (6e-15 with 30; 2e-16 with 3, which splits most blocks of a plate).
constexpr double worst_condition = 10;

}  // namespace

/// Turns one supernode after the other from L L' into U S U'.
class SupernodalFactor::Builder {
public:
    Builder(SupernodalFactor& out, const SupernodalCholesky& L) : out_(out), L_(L) {
        // A bound, so that nothing is moved; memory that is not touched costs nothing.
        std::size_t lines = 0, columns = static_cast<std::size_t>(L.n);
        for (Index s = 0; s < L.supernodes; ++s) {
            const auto rows = static_cast<std::size_t>(L.row_begin[s + 1] - L.row_begin[s]);
            lines += (rows + 2 * widest) * static_cast<std::size_t>(L.super[s + 1] - L.super[s]) / 8 + 1;
        }
        out_.values_.reserve(lines);
        out_.inverses_.reserve(columns);
    }

    void add(Index s) {
        rows_ = L_.row_begin[s + 1] - L_.row_begin[s];
        columns_ = L_.super[s + 1] - L_.super[s];
        panel_.assign(L_.values + L_.value_begin[s], L_.values + L_.value_begin[s] + rows_ * columns_);
        Supernode node{};
        node.first = static_cast<std::int32_t>(L_.super[s]);
        node.width = static_cast<std::int32_t>(columns_);
        node.blocks_begin = static_cast<std::int32_t>(out_.blocks_.size());
        for (Index first = 0; first < columns_;) first += eliminate_block(first);
        node.blocks_end = static_cast<std::int32_t>(out_.blocks_.size());
        find_leading_zeros();
        node.values_begin = static_cast<std::int64_t>(out_.values_.size()) * 8;
        band_values_.clear();
        for (auto b = node.blocks_begin; b < node.blocks_end; ++b)
            store_block_band(out_.blocks_[static_cast<std::size_t>(b)]);
        node.bands_begin = static_cast<std::int32_t>(out_.bands_.size());
        node.rows_begin = static_cast<std::int32_t>(out_.rows_.size());
        store_bands(L_.rows + L_.row_begin[s]);
        node.bands_end = static_cast<std::int32_t>(out_.bands_.size());
        node.rows_end = static_cast<std::int32_t>(out_.rows_.size());
        node.inverses_end = static_cast<std::int32_t>(out_.inverses_.size());
        node.parent = parent(s);
        node.values_end = node.values_begin + static_cast<std::int64_t>(band_values_.size());
        append(band_values_, out_.values_);
        out_.supernodes_.push_back(node);
        out_.widest_supernode_ = std::max(out_.widest_supernode_, node.width);
    }

private:
    using Small = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, widest, widest>;

    std::int32_t parent(Index s) const {
        if (rows_ == columns_) return -1;
        const long below = L_.rows[L_.row_begin[s] + columns_];
        return static_cast<std::int32_t>(std::upper_bound(L_.super, L_.super + L_.supernodes, below) - L_.super) - 1;
    }

    double* column(Index j) { return panel_.data() + j * rows_; }

    /// Takes the block's triangle T out of the rows below, U = L T^-1, and stores (T T')^-1. Answers the width.
    Index eliminate_block(Index first) {
        const Eigen::Map<const DenseMatrix> panel(panel_.data(), rows_, columns_);
        Small T, inverse;
        Index width = std::min<Index>(widest, columns_ - first);
        for (;; width = (width + 1) / 2) {
            T = panel.block(first, first, width, width).triangularView<Eigen::Lower>();
            inverse = invert(T);
            if (width == 1 ||
                inverse.cwiseAbs().lazyProduct(T.cwiseAbs()).rowwise().sum().maxCoeff() <= worst_condition)
                break;
        }
        const Index end = first + width;
        const auto below = [&](Index j) { return Eigen::Map<Vector>(column(first + j) + end, rows_ - end); };
        for (Index j = width; j-- > 0;) {
            for (Index k = j + 1; k < width; ++k) below(j) -= T(k, j) * below(k);
            below(j) /= T(j, j);
        }
        std::vector<double>& S = inverse_values_;
        const int height = height_for(width);
        S.assign(static_cast<std::size_t>(height * width), 0);
        for (Index j = 0; j < width; ++j)
            for (Index i = 0; i < width; ++i)
                S[static_cast<std::size_t>(j * height + i)] = inverse.col(i).dot(inverse.col(j));
        append(S, out_.inverses_);
        out_.blocks_.push_back({static_cast<std::int32_t>(first), static_cast<std::int32_t>(width)});
        return width;
    }

    static Small invert(const Small& T) {
        Small inverse = Small::Zero(T.rows(), T.cols());
        for (Index j = 0; j < T.cols(); ++j) {
            inverse(j, j) = 1 / T(j, j);
            for (Index i = j + 1; i < T.rows(); ++i) {
                double sum = 0;
                for (Index k = j; k < i; ++k) sum += T(i, k) * inverse(k, j);
                inverse(i, j) = -sum / T(i, i);
            }
        }
        return inverse;
    }

    /// What the library's amalgamation filled up is exactly zero.
    void find_leading_zeros() {
        start_.assign(static_cast<std::size_t>(rows_), static_cast<std::int32_t>(columns_));
        for (Index j = columns_; j-- > 0;) {
            const double* entries = column(j);
            std::int32_t* start = start_.data();
            const auto here = static_cast<std::int32_t>(j);
            for (Index i = j + 1; i < rows_; ++i) start[i] = entries[i] != 0 ? here : start[i];
        }
    }

    double* new_band(std::int32_t from, std::int32_t to, int height) {
        const std::size_t size = band_values_.size();
        band_values_.resize(size + static_cast<std::size_t>((to - from) * height));
        return band_values_.data() + size;
    }

    void store_block_band(const DiagonalBlock& block) {
        auto from = block.first;
        for (int i = 0; i < block.width; ++i)
            from = std::min(from, start_[static_cast<std::size_t>(block.first + i)]);
        const int height = height_for(block.width);
        out_.block_bands_.push_back({from, height});
        double* to = new_band(from, block.first, height);
        for (Index j = from; j < block.first; ++j, to += height)
            std::copy_n(column(j) + block.first, block.width, to);
    }

    /// The rows below with equally many leading zeros come together; the last band is filled up with row n.
    void store_bands(const long* rows) {
        order_.resize(static_cast<std::size_t>(rows_ - columns_));
        std::iota(order_.begin(), order_.end(), static_cast<std::int32_t>(columns_));
        const auto start = [&](std::int32_t row) { return start_[static_cast<std::size_t>(row)]; };
        std::stable_sort(order_.begin(), order_.end(), [&](auto a, auto b) { return start(a) < start(b); });
        while (!order_.empty() && start(order_.back()) == columns_) order_.pop_back();
        const std::int32_t* row = order_.data();
        for (auto left = static_cast<int>(order_.size()); left > 0;) {
            const int height = height_for(left), used = std::min(height, left);
            const auto from = start(*row);
            out_.bands_.push_back({from, height});
            for (int i = 0; i < height; ++i)
                out_.rows_.push_back(static_cast<std::int32_t>(i < used ? rows[row[i]] : L_.n));
            double* to = new_band(from, static_cast<std::int32_t>(columns_), height);
            for (Index j = from; j < columns_; ++j, to += height)
                for (int i = 0; i < used; ++i) to[i] = column(j)[row[i]];
            row += used;
            left -= used;
        }
    }

    /// Everything begins on a cache line.
    static void append(const std::vector<double>& from, std::vector<Line>& to) {
        const std::size_t size = to.size();
        to.resize(size + (from.size() + 7) / 8);
        if (!from.empty()) std::copy(from.begin(), from.end(), to[size].entries);
    }

    SupernodalFactor& out_;
    const SupernodalCholesky& L_;
    Index rows_ = 0, columns_ = 0;
    std::vector<double> panel_, band_values_, inverse_values_;
    std::vector<std::int32_t> start_, order_;
};

SupernodalFactor::SupernodalFactor(const SupernodalCholesky& L) : n_(L.n) {
    Builder builder(*this, L);
    for (Index s = 0; s < L.supernodes; ++s) builder.add(s);
    if (values_.empty()) values_.emplace_back();
    row_of_.resize(static_cast<std::size_t>(n_));
    for (Index i = 0; i < n_; ++i) row_of_[static_cast<std::size_t>(L.permutation[i])] = static_cast<std::int32_t>(i);
}

}  // namespace tact
