#include "saddle_system.hpp"

namespace tact {

SaddleSystem::SaddleSystem(const SparseMatrix& A, const SparseMatrix& Ct, double regularisation)
    : n_(A.rows()), k_(Ct.cols()), regularisation_(regularisation) {
    std::vector<Eigen::Triplet<double, long>> entries;
    entries.reserve(static_cast<std::size_t>(A.nonZeros() + Ct.nonZeros() + n_ + k_));
    for (Index j = 0; j < n_; ++j)
        for (SparseMatrix::InnerIterator it(A, j); it; ++it)
            if (it.row() >= j) entries.emplace_back(it.row(), j, it.value());
    for (Index i = 0; i < k_; ++i)
        for (SparseMatrix::InnerIterator it(Ct, i); it; ++it) entries.emplace_back(n_ + i, it.row(), it.value());
    for (Index i = 0; i < n_ + k_; ++i) entries.emplace_back(i, i, 0.0);
    K_.resize(n_ + k_, n_ + k_);
    K_.setFromTriplets(entries.begin(), entries.end());
    for (Index j = 0; j < K_.cols(); ++j) diagonal_.push_back(K_.outerIndexPtr()[j]);  // first in its column
    unshifted_ = K_.diagonal();
    ldlt_.analyzePattern(K_);
}

bool SaddleSystem::factor(const Vector& d, const Vector& theta) {
    exact_ = unshifted_;
    exact_.head(n_) += d;
    exact_.tail(k_) -= theta;
    double* value = K_.valuePtr();
    for (Index j = 0; j < n_ + k_; ++j)
        value[diagonal_[static_cast<std::size_t>(j)]] = exact_[j] + (j < n_ ? regularisation_ : -regularisation_);
    ldlt_.factorize(K_);
    return ldlt_.info() == Eigen::Success && ldlt_.vectorD().allFinite();
}

void SaddleSystem::solve(Vector& f, Vector& g) {
    Vector right(n_ + k_);
    right << f, g;
    x_ = ldlt_.solve(right);
    double last = infinity;
    Vector best = x_;
    for (int round = 0; round < 40; ++round) {
        r_ = right - K_.selfadjointView<Eigen::Lower>() * x_;
        r_.head(n_) += regularisation_ * x_.head(n_);
        r_.tail(k_) -= regularisation_ * x_.tail(k_);
        const double size = r_.lpNorm<Eigen::Infinity>();
        if (!(size < last)) break;
        best = x_;
        if (size == 0 || size > 0.9 * last) break;
        last = size;
        x_ += ldlt_.solve(r_);
    }
    f = best.head(n_);
    g = -best.tail(k_);
}

}  // namespace tact
