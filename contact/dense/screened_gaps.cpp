#include "tact/contact/dense/screened_gaps.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace tact {
namespace {

/// Of |B_i||u| and |c_i|: above the rounding of any sum of up to 10000 terms.
constexpr double rounding = 1e-12;

/// The least number that is above c by more than rounding; -infinity stays.
double beyond(double c) { return c * (c > 0 ? 1 + rounding : 1 - rounding); }

/// Not below the length of what is left of a vector of size n, of squared length `total`, without a part of it.
double length_left(double total, double part, Index n) {
    const double lost = static_cast<double>(n) * std::numeric_limits<double>::epsilon() * total;  // by rounding
    return std::sqrt(std::max(total - part, 0.0) + lost);
}

}  // namespace

ScreenedGaps::ScreenedGaps(const DenseMatrix& B)
    : B_(B),
      column_size_(B.colwise().norm()),
      row_size_(B.rowwise().norm()),
      squares_(Vector::Zero(B.cols())),
      order_(Eigen::VectorXi::LinSpaced(B.cols(), 0, static_cast<int>(B.cols()) - 1)),
      lower_(B.rows()),
      slack_(B.rows()) {}

void ScreenedGaps::sort_columns() {
    const Vector weight = squares_.cwiseSqrt().cwiseProduct(column_size_);
    std::iota(order_.begin(), order_.end(), 0);
    std::stable_sort(order_.begin(), order_.end(), [&](int a, int b) { return weight[a] > weight[b]; });
    const Index second = std::min(more, B_.cols());
    head_ = B_(Eigen::all, order_.head(leading));
    middle_ = B_(Eigen::all, order_.head(second));
    tail_size_ = B_(Eigen::all, order_.tail(B_.cols() - leading)).rowwise().norm();
    far_tail_size_ = B_(Eigen::all, order_.tail(B_.cols() - second)).rowwise().norm();
}

bool ScreenedGaps::all_open(const ConstVectorRef& u, const ConstVectorRef& c) {
    // What leads changes little, and the order decides nothing but the time: looked at ever more rarely.
    constexpr long every = 8;
    if (calls_ < every || calls_ % every == 0) squares_ += u.cwiseAbs2();
    if (++calls_ == next_sort_) {
        next_sort_ *= 4;
        sort_columns();
    }
    std::array<double, leading> first;
    for (Index j = 0; j < leading; ++j) first[static_cast<std::size_t>(j)] = u[order_[j]];
    const Eigen::Map<const Eigen::Matrix<double, leading, 1>> head(first.data());
    const double total = u.squaredNorm(), tail = length_left(total, head.squaredNorm(), u.size());
    const double allowance = rounding * std::sqrt(total * static_cast<double>(u.size()));
    lower_.noalias() = head_ * head;
    double doubtful = 0;
    for (Index i = 0; i < lower_.size(); ++i) {
        slack_[i] = lower_[i] - tail_size_[i] * tail - beyond(c[i]) - allowance * row_size_[i];
        doubtful += slack_[i] > 0 ? 0.0 : 1.0;
    }
    return doubtful == 0 || open_at_second_look(u, c, total, allowance);
}

bool ScreenedGaps::open_at_second_look(const ConstVectorRef& u, const ConstVectorRef& c, double total,
                                       double allowance) {
    std::array<double, more> first;
    const Index count = middle_.cols();
    for (Index j = 0; j < count; ++j) first[static_cast<std::size_t>(j)] = u[order_[j]];
    const Eigen::Map<const Vector> part(first.data(), count);
    const double tail = length_left(total, part.squaredNorm(), u.size());
    for (Index i = 0; i < slack_.size(); ++i) {
        if (slack_[i] > 0) continue;
        const double bound = beyond(c[i]) + allowance * row_size_[i];
        if (middle_.row(i).dot(part) - far_tail_size_[i] * tail > bound) continue;
        if (!(B_.row(i).dot(u) > bound)) return false;
    }
    return true;
}

}  // namespace tact
