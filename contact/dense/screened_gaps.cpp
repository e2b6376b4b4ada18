#include "tact/contact/dense/screened_gaps.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace tact {
namespace {

/// Of |B_i||u| and |c_i|: above the rounding of any sum of up to 10000 terms.
constexpr double rounding = 1e-12;

/// The least number that is above c by more than rounding; -infinity stays.
double beyond(double c) { return c > 0 ? c * (1 + rounding) : c * (1 - rounding); }

}  // namespace

ScreenedGaps::ScreenedGaps(const DenseMatrix& B)
    : B_(B),
      column_size_(B.colwise().norm()),
      row_size_(B.rowwise().norm()),
      squares_(Vector::Zero(B.cols())),
      order_(Eigen::VectorXi::LinSpaced(B.cols(), 0, static_cast<int>(B.cols()) - 1)),
      sorted_(B.cols()),
      lower_(B.rows()) {}

void ScreenedGaps::sort_columns() {
    const Vector weight = squares_.cwiseSqrt().cwiseProduct(column_size_);
    std::iota(order_.begin(), order_.end(), 0);
    std::stable_sort(order_.begin(), order_.end(), [&](int a, int b) { return weight[a] > weight[b]; });
    head_ = B_(Eigen::all, order_.head(leading));
    tail_ = B_(Eigen::all, order_.tail(B_.cols() - leading));
    tail_size_ = tail_.rowwise().norm();
}

bool ScreenedGaps::all_open(const ConstVectorRef& u, const ConstVectorRef& c) {
    squares_ += u.cwiseAbs2();
    if (++calls_ == next_sort_) {
        // Ever more rarely: what leads changes little, and the order decides nothing but the time.
        next_sort_ *= 4;
        sort_columns();
    }
    for (Index j = 0; j < u.size(); ++j) sorted_[j] = u[order_[j]];
    const auto u_tail = sorted_.tail(u.size() - leading);
    const double tail_length = u_tail.norm();
    lower_.noalias() = head_ * sorted_.head(leading);
    const double allowance = rounding * std::sqrt(u.size()) * sorted_.norm();
    for (Index i = 0; i < lower_.size(); ++i) {
        const double bound = beyond(c[i]) + allowance * row_size_[i];
        if (lower_[i] - tail_size_[i] * tail_length > bound) continue;
        if (!(lower_[i] + tail_.row(i).dot(u_tail) > bound)) return false;
    }
    return true;
}

}  // namespace tact
