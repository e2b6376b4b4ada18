#include "schur_factor.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace tact {
namespace {

/// What a change costs, in k'ths of a factor of k rows (measured from 90 to 720).
constexpr Index cost_of_leaving = 12, cost_of_joining = 5;

}  // namespace

void SchurFactor::reserve(Index k) {
    if (L_.rows() >= k) return;
    const Index capacity = std::max<Index>(16, std::max(k, 2 * L_.rows()));
    L_.conservativeResize(capacity, capacity);
    work_.resize(capacity);
    rows_.reserve(static_cast<std::size_t>(capacity));
}

void SchurFactor::solve_lower(VectorRef x) const {
    const Index k = size();
    if (k > 64) {
        L_.topLeftCorner(k, k).triangularView<Eigen::Lower>().solveInPlace(x.head(k));
        return;
    }
    for (Index j = 0; j < k; ++j) {
        const double* column = L_.col(j).data();
        const double xj = x[j] /= column[j];
        for (Index i = j + 1; i < k; ++i) x[i] -= xj * column[i];
    }
}

void SchurFactor::solve_upper(VectorRef x) const {
    const Index k = size();
    if (k > 64) {
        L_.topLeftCorner(k, k).triangularView<Eigen::Lower>().transpose().solveInPlace(x.head(k));
        return;
    }
    // Rows of L in turn: each x_j leaves those above it, which do not wait for one another.
    for (Index j = k - 1; j >= 0; --j) {
        const double* row = L_.data() + j;
        const double xj = x[j] /= row[j * L_.rows()];
        for (Index i = 0; i < j; ++i) x[i] -= xj * row[i * L_.rows()];
    }
}

void SchurFactor::solve(VectorRef x) const {
    solve_lower(x);
    solve_upper(x);
}

double SchurFactor::pivot(const DenseMatrix& S, Index q, VectorRef l) const {
    const Index k = size();
    for (Index i = 0; i < k; ++i) l[i] = S(rows_[static_cast<std::size_t>(i)], q);
    solve_lower(l.head(k));
    return S(q, q) - l.head(k).squaredNorm();
}

void SchurFactor::append(Index q, const ConstVectorRef& l, double pivot) {
    const Index k = size();
    reserve(k + 1);
    L_.row(k).head(k) = l.head(k).transpose();
    L_(k, k) = std::sqrt(pivot);
    rows_.push_back(q);
}

bool SchurFactor::append(const DenseMatrix& S, Index q) {
    reserve(size() + 1);
    const double p = pivot(S, q, work_);
    if (!(p > dependence * S(q, q))) return false;
    append(q, work_, p);
    return true;
}

void SchurFactor::remove(Index place) {
    const Index k = size();
    for (Index j = 0; j < k; ++j) {
        double* column = L_.col(j).data();
        for (Index i = std::max(j, place + 1); i < k; ++i) column[i - 1] = column[i];
    }
    // The rows moved up carry one entry right of the diagonal, at (i, i + 1): rotate it away, column by column.
    // After the shift column j still holds at [j-1] the entry that was its diagonal.
    for (Index j = place; j + 1 < k; ++j) {
        double* left = L_.col(j).data();
        double* right = L_.col(j + 1).data();
        const double a = left[j], b = right[j];
        const double r = std::hypot(a, b);
        const double c = a / r, s = b / r;
        left[j] = r;
        for (Index i = j + 1; i < k - 1; ++i) {
            const double x = left[i], y = right[i];
            left[i] = c * x + s * y;
            right[i] = c * y - s * x;
        }
    }
    rows_.erase(rows_.begin() + place);
}

void SchurFactor::rebuild(const DenseMatrix& S, std::span<const Index> rows) {
    const Index k = static_cast<Index>(rows.size());
    rows_.clear();
    reserve(k);
    if (k > 48) {
        for (Index j = 0; j < k; ++j)
            for (Index i = j; i < k; ++i)
                L_(i, j) = S(rows[static_cast<std::size_t>(i)], rows[static_cast<std::size_t>(j)]);
        work_.head(k) = L_.diagonal().head(k);
        Eigen::Ref<DenseMatrix> block = L_.topLeftCorner(k, k);
        Eigen::LLT<Eigen::Ref<DenseMatrix>> llt(block);
        if (llt.info() == Eigen::Success &&
            (L_.diagonal().head(k).array().square() > dependence * work_.head(k).array()).all()) {
            rows_.assign(rows.begin(), rows.end());
            return;
        }
    }
    for (const Index q : rows) append(S, q);
}

bool SchurFactor::change(const DenseMatrix& S, std::span<const Index> rows) {
    wanted_.assign(static_cast<std::size_t>(S.rows()), 0);
    for (const Index q : rows) wanted_[static_cast<std::size_t>(q)] = 1;
    const auto kept = std::count_if(rows_.begin(), rows_.end(),
                                    [this](Index q) { return wanted_[static_cast<std::size_t>(q)] != 0; });
    const auto count = static_cast<Index>(rows.size());
    if (cost_of_leaving * (size() - kept) + cost_of_joining * (count - kept) > count) {
        rebuild(S, rows);
        return false;
    }
    for (Index place = size(); place-- > 0;)
        if (!wanted_[static_cast<std::size_t>(rows_[static_cast<std::size_t>(place)])]) remove(place);
    for (const Index q : rows_) wanted_[static_cast<std::size_t>(q)] = 0;
    fresh_.clear();
    for (const Index q : rows)
        if (wanted_[static_cast<std::size_t>(q)]) fresh_.push_back(q);
    if (fresh_.empty() || append_all(S, fresh_)) return true;
    rebuild(S, rows);
    return false;
}

/// The new rows of L are [X' T]: X = L^-1 S(C, fresh), T T' = S(fresh, fresh) - X'X.
bool SchurFactor::append_all(const DenseMatrix& S, std::span<const Index> fresh) {
    const Index k = size(), count = static_cast<Index>(fresh.size());
    reserve(k + count);
    DenseMatrix X(k, count), T(count, count);
    for (Index j = 0; j < count; ++j) {
        const double* column = S.col(fresh[static_cast<std::size_t>(j)]).data();
        for (Index i = 0; i < k; ++i) X(i, j) = column[rows_[static_cast<std::size_t>(i)]];
        for (Index i = 0; i < count; ++i) T(i, j) = column[fresh[static_cast<std::size_t>(i)]];
    }
    const Vector diagonal = T.diagonal();
    L_.topLeftCorner(k, k).triangularView<Eigen::Lower>().solveInPlace(X);
    T.selfadjointView<Eigen::Lower>().rankUpdate(X.transpose(), -1);
    const Eigen::LLT<Eigen::Ref<DenseMatrix>> llt(T);
    if (llt.info() != Eigen::Success || !(T.diagonal().array().square() > dependence * diagonal.array()).all())
        return false;
    L_.block(k, 0, count, k) = X.transpose();
    L_.block(k, k, count, count) = T;
    rows_.insert(rows_.end(), fresh.begin(), fresh.end());
    return true;
}

}  // namespace tact
