#include "band_factor.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <sstream>

#include "../errors.hpp"

namespace tact {
namespace {

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

/// A reciprocal condition by pivots at this level is a floating body that slipped through.
constexpr double singular = 1e-15;

}  // namespace

Index BandFactor::half_width(const SparseMatrix& A) {
    Index width = 1;
    for (Index j = 0; j < A.cols(); ++j)
        for (SparseMatrix::InnerIterator it(A, j); it; ++it) {
            width = std::max<Index>(width, std::abs(it.row() - j));
            if (width > widest) return A.cols();
        }
    return A.cols() >= 4 * width ? width : A.cols();
}

BandFactor::BandFactor(const SparseMatrix& A, const std::string& name)
    : n_(A.cols()),
      width_(half_width(A)),
      ends_((n_ - width_) / 2),
      middle_(n_ - 2 * ends_),
      lower_(at((ends_ + width_) * width_), Pair{}),
      inverse_(at(ends_), Pair{}),
      work_(at(ends_ + 2 * width_), Pair{}) {
    DenseMatrix middle = DenseMatrix(A.block(ends_, ends_, middle_, middle_)).selfadjointView<Eigen::Lower>();
    eliminate(A, 0, middle, name);
    eliminate(A, 1, middle, name);
    const Eigen::LLT<DenseMatrix> factor(middle);
    if (factor.info() != Eigen::Success)
        throw NumericalError("BandFactor: " + name + " is singular or not positive definite (rows in the middle)");
    root_ = factor.matrixL();
    double least = infinity, most = 0;
    for (const Pair& inverse : inverse_)
        for (int end = 0; end < 2; ++end) {
            least = std::min(least, 1 / inverse[end]);
            most = std::max(most, 1 / inverse[end]);
        }
    least = std::min(least, root_.diagonal().cwiseAbs2().minCoeff());
    most = std::max(most, root_.diagonal().cwiseAbs2().maxCoeff());
    if (!(least > singular * most)) {
        std::ostringstream text;
        text << "BandFactor: " << name << " is singular to rounding (reciprocal condition " << least / most << ")";
        throw NumericalError(text.str());
    }
}

/// L and D of the rows at one end, in the order from there, and what they take from `middle`.
void BandFactor::eliminate(const SparseMatrix& A, int end, DenseMatrix& middle, const std::string& name) {
    const auto row = [&](Index i) { return end == 0 ? i : n_ - 1 - i; };
    const Index rows = ends_ + width_;
    // band(k, i) = A(i, i - k), both counted from this end
    DenseMatrix band = DenseMatrix::Zero(width_ + 1, rows);
    for (Index i = 0; i < rows; ++i)
        for (Index k = 0; k <= std::min(i, width_); ++k)
            band(k, i) = A.coeff(std::max(row(i), row(i - k)), std::min(row(i), row(i - k)));
    const DenseMatrix before = band.rightCols(width_);
    for (Index i = 0; i < ends_; ++i) {
        const double pivot = band(0, i);
        if (!(pivot > 0))
            throw NumericalError("BandFactor: " + name + " is singular or not positive definite (pivot " +
                                 std::to_string(row(i)) + ")");
        inverse_[at(i)][end] = 1 / pivot;
        for (Index k = 1; k <= width_; ++k) {
            const double factor = band(k, i + k) / pivot;
            lower_[at((i + k) * width_ + k - 1)][end] = factor;
            for (Index j = 1; j <= k; ++j) band(k - j, i + k) -= factor * band(j, i + j);
        }
    }
    for (Index i = 0; i < width_; ++i)
        for (Index k = 0; k <= i; ++k) {
            const Index here = row(ends_ + i) - ends_, there = row(ends_ + i - k) - ends_;
            const double change = band(k, ends_ + i) - before(k, i);
            middle(here, there) += change;
            if (k > 0) middle(there, here) += change;
        }
}

template <Index width> void BandFactor::solve_width(double* x) const {
    Pair* z = work_.data() + width;  // zeros before it
    for (Index i = 0; i < ends_; ++i) {
        Pair sum = {x[i], x[n_ - 1 - i]};
        const Pair* lower = lower_.data() + i * width;
        // The last one computed comes last: it is the one to wait for.
        for (Index k = width; k > 0; --k) sum -= lower[k - 1] * z[i - k];
        z[i] = sum;
    }
    double* between = x + ends_;
    for (Index i = 0; i < width; ++i) {
        Pair sum = {};
        const Pair* lower = lower_.data() + (ends_ + i) * width;
        for (Index k = width; k > i; --k) sum -= lower[k - 1] * z[ends_ + i - k];
        between[i] += sum[0];
        between[middle_ - 1 - i] += sum[1];
    }
    Eigen::Map<Vector> rest(between, middle_);
    root_.triangularView<Eigen::Lower>().solveInPlace(rest);
    root_.transpose().triangularView<Eigen::Upper>().solveInPlace(rest);
    for (Index i = 0; i < width; ++i) z[ends_ + i] = Pair{between[i], between[middle_ - 1 - i]};
    for (Index i = ends_ - 1; i >= 0; --i) {
        Pair sum = z[i] * inverse_[at(i)];
        for (Index k = width; k > 0; --k) sum -= lower_[at((i + k) * width + k - 1)] * z[i + k];
        z[i] = sum;
        x[i] = sum[0];
        x[n_ - 1 - i] = sum[1];
    }
}

void BandFactor::solve(double* x) const {
    switch (width_) {
        case 1: return solve_width<1>(x);
        case 2: return solve_width<2>(x);
        case 3: return solve_width<3>(x);
        default: return solve_width<4>(x);
    }
}

}  // namespace tact
