#include "screened_gaps.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace tact {
namespace {

/// Of |B_i||u| and |c_i|: above the rounding of any sum of up to 10000 terms.
constexpr double rounding = 1e-12;
/// Twice what one operation in single precision rounds by.
constexpr float single_rounding = 1.2e-7F;

/// The least number that is above c by more than rounding; -infinity stays.
double beyond(double c) { return c * (c > 0 ? 1 + rounding : 1 - rounding); }

constexpr Index lanes = 16;
typedef float Lanes __attribute__((vector_size(sizeof(float) * lanes)));  // NOLINT: `using` takes no attribute

typedef int Flags __attribute__((vector_size(sizeof(int) * lanes)));  // NOLINT

Lanes load(const float* x) {
    Lanes v;
    std::memcpy(&v, x, sizeof v);
    return v;
}
void store(const Lanes& v, float* x) { std::memcpy(x, &v, sizeof v); }

/// sum += the strip's columns [first, last) times u, in two sums because one would wait for itself; from nothing where
/// first is 0.
template <int vectors> void add_columns(const float* entries, const float* u, Index first, Index last, float* sum) {
    constexpr int ways = 2;
    Lanes total[ways][vectors] = {};
    if (first > 0)
        for (int k = 0; k < vectors; ++k) total[1][k] = load(sum + k * lanes);
    const float* column = entries + first * vectors * lanes;
    Index j = first;
    for (; j + ways <= last; j += ways)
        for (int way = 0; way < ways; ++way, column += vectors * lanes)
            for (int k = 0; k < vectors; ++k) total[way][k] += load(column + k * lanes) * u[j + way];
    if (j < last)
        for (int k = 0; k < vectors; ++k) total[0][k] += load(column + k * lanes) * u[j];
    for (int k = 0; k < vectors; ++k) store(total[0][k] + total[1][k], sum + k * lanes);
}

}  // namespace

ScreenedGaps::ScreenedGaps(const DenseMatrix& B)
    : B_(B),
      row_size_(B.rowwise().norm()),
      // A row whose length has overflowed or nearly vanished proves nothing in these units.
      inverse_size_(row_size_.unaryExpr([](double size) {
          return size > 1e-140 && size < 1e140 ? 1 / size : std::numeric_limits<double>::quiet_NaN();
      })),
      near_(std::min<Index>(32, B.cols())),
      far_(std::min<Index>(64, B.cols())) {
    const Index m = B.rows(), vectors = (m + lanes - 1) / lanes, strips = (vectors + widest - 1) / widest;
    const Index padded = vectors * lanes;
    entries_.setZero(padded * B.cols());
    for (Index s = 0, row = 0; s < strips; ++s) {
        const Index wide = vectors / strips + (s < vectors % strips ? 1 : 0);
        float* strip = entries_.data() + row * B.cols();
        strips_.push_back({row, wide, strip});
        for (Index j = 0; j < B.cols(); ++j)
            for (Index i = row; i < std::min(m, row + wide * lanes); ++i)
                if (row_size_[i] > 0) strip[j * wide * lanes + i - row] = static_cast<float>(B(i, j) / row_size_[i]);
        row += wide * lanes;
    }
    const auto tail = [&](Index columns) {
        Eigen::VectorXf size = Eigen::VectorXf::Zero(padded);
        for (Index i = 0; i < m; ++i)
            if (row_size_[i] > 0)
                size[i] = static_cast<float>(B.row(i).tail(B.cols() - columns).norm() / row_size_[i] * 1.000001);
        return size;
    };
    near_tail_ = tail(near_);
    far_tail_ = tail(far_);
    no_tail_ = tail(B.cols());
    direction_.resize(B.cols());
    sum_.resize(padded);
    bound_ = Eigen::VectorXf::Constant(padded, -std::numeric_limits<float>::infinity());
    marks_.setZero(padded);
    doubt_.reserve(static_cast<std::size_t>(m));
}

void ScreenedGaps::take_columns(Index first, Index last) {
    for (const Strip& strip : strips_) {
        const auto add = [&]<int... vectors>(std::integer_sequence<int, vectors...>) {
            ((strip.vectors == vectors + 1 ? add_columns<vectors + 1>(strip.entries, direction_.data(), first, last,
                                                                      sum_.data() + strip.first_row)
                                           : void()),
             ...);
        };
        add(std::make_integer_sequence<int, static_cast<int>(widest)>());
    }
}

Index ScreenedGaps::mark_doubts(const Eigen::VectorXf& tail_size, double tail, Index columns, double size) {
    const float left = static_cast<float>(tail * 1.000001);
    const float allowance = single_rounding * static_cast<float>(columns + 4) * static_cast<float>(size * 1.000001);
    const float *sum = sum_.data(), *reach = tail_size.data(), *bound = bound_.data();
    Flags marked = {};
    for (Index i = 0; i < sum_.size(); i += lanes) {
        const Flags open = load(sum + i) - load(reach + i) * left - allowance > load(bound + i);
        marked += open;
        const Flags doubt = ~open;
        std::memcpy(marks_.data() + i, &doubt, sizeof doubt);
    }
    Index count = sum_.size();
    for (Index l = 0; l < lanes; ++l) count += marked[l];
    return count;
}

std::span<const Index> ScreenedGaps::in_doubt(const ConstVectorRef& u, const ConstVectorRef& c) {
    const Index m = B_.rows(), p = B_.cols();
    const double first = u.head(near_).squaredNorm(), second = u.segment(near_, far_ - near_).squaredNorm(),
                 third = u.tail(p - far_).squaredNorm();
    const double total = first + second + third;
    doubt_.clear();
    // In units that single precision holds. Where |u|^2 is no number that can be trusted, no bound holds, and every row is
    // in doubt.
    const bool measured = total > 1e-280 && total < infinity;
    const double unit = total > 1e-30 && total < 1e30 ? 1 : 1 / std::sqrt(total);
    if (!measured) {
        marks_.setConstant(-1);
    } else if (!take_looks(u, c, total, second, third, unit)) {
        return {};
    }
    const double allowance = rounding * std::sqrt(total * static_cast<double>(p));
    for (Index i = 0; i < m; ++i)
        if (marks_[i] != 0 && !(B_.row(i).dot(u) > beyond(c[i]) + allowance * row_size_[i])) doubt_.push_back(i);
    return doubt_;
}

bool ScreenedGaps::take_looks(const ConstVectorRef& u, const ConstVectorRef& c, double total, double second,
                              double third, double unit) {
    const Index m = B_.rows(), p = B_.cols();
    // Impact laws leave a few rows switched on: each on its own then costs less than a look.
    int on = 0;
    for (Index i = 0; i < m; ++i) {
        marks_[i] = c[i] == -infinity ? 0 : 1;
        on += marks_[i];
    }
    if (4 * on <= m) return on > 0;
    for (Index i = 0; i < m; ++i) {
        const float bound = static_cast<float>(c[i] * inverse_size_[i] * unit);
        bound_[i] = std::max(bound * (1 + 4 * single_rounding), bound * (1 - 4 * single_rounding));
    }
    const double size = std::sqrt(total) * unit;
    for (Index j = 0; j < p; ++j) direction_[j] = static_cast<float>(u[j] * unit);
    const auto look_at_all = [&](Index from) {
        take_columns(from, p);
        return needs_all_ = mark_doubts(no_tail_, 0, p, size) > 0;
    };
    if (needs_all_) return look_at_all(0);
    take_columns(0, near_);
    if (mark_doubts(near_tail_, std::sqrt(second + third) * unit, near_, size) == 0) return false;
    take_columns(near_, far_);
    const Index doubts = mark_doubts(far_tail_, std::sqrt(third) * unit, far_, size);
    constexpr Index few = 6;
    if (doubts <= few || far_ == p) return doubts > 0;
    return look_at_all(far_);
}

}  // namespace tact
