#include "touched_rows.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "../../lib/algebra/linear_solver.hpp"

namespace tact {

Pool::Pool(const Factor& factor, TransposedSolve transposed, const ConstraintRows& rows, std::size_t bytes)
    : factor_(factor),
      transposed_(std::move(transposed)),
      rows_(rows),
      largest_(static_cast<Index>(std::sqrt(static_cast<double>(bytes) / sizeof(double)))) {
    place_.assign(static_cast<std::size_t>(rows.rows()), -1);
}

void Pool::add(const std::vector<Index>& fresh) {
    if (fresh.empty()) return;
    const Index old = size();
    for (const Index row : fresh) {
        place_[static_cast<std::size_t>(row)] = size();
        members_.push_back(row);
    }
    reserve();
    if (transposed_) return add_unsymmetric(old);
    factor_.compliance(columns(), old, S_);
    for (Index j = old; j < size(); ++j) S_.row(j).head(j) = S_.col(j).head(j).transpose();
}

/// Columns of S from A^-1 B', its rows from A^-T B'.
void Pool::add_unsymmetric(Index old) {
    constexpr Index batch = 32;
    const SparseMatrix R = columns();
    for (Index j = old; j < size(); j += batch) {
        const Index count = std::min(batch, size() - j);
        DenseMatrix X = R.middleCols(j, count), Y = X;
        factor_.solve(X);
        transposed_(Y);
        S_.block(0, j, size(), count).noalias() = R.transpose() * X;
        S_.block(j, 0, count, old).noalias() = (R.leftCols(old).transpose() * Y).transpose();
    }
}

/// Forgets all rows but those given; their mutual compliance is kept.
void Pool::keep(const std::vector<Index>& rows) {
    DenseMatrix kept(static_cast<Index>(rows.size()), static_cast<Index>(rows.size()));
    for (Index j = 0; j < kept.cols(); ++j)
        for (Index i = 0; i < kept.rows(); ++i)
            kept(i, j) = S_(place_[static_cast<std::size_t>(rows[static_cast<std::size_t>(i)])],
                            place_[static_cast<std::size_t>(rows[static_cast<std::size_t>(j)])]);
    for (const Index row : members_) place_[static_cast<std::size_t>(row)] = -1;
    members_ = rows;
    for (Index i = 0; i < kept.rows(); ++i) place_[static_cast<std::size_t>(rows[static_cast<std::size_t>(i)])] = i;
    S_ = std::move(kept);
}

/// The members' rows of B as columns.
SparseMatrix Pool::columns() const {
    SparseMatrix R(factor_.size(), size());
    for (Index j = 0; j < size(); ++j) {
        const Index row = members_[static_cast<std::size_t>(j)];
        R.startVec(j);
        for (std::size_t k = 0; k < rows_.columns(row).size(); ++k)
            R.insertBack(rows_.columns(row)[k], j) = rows_.weights(row)[k];
    }
    R.finalize();
    return R;
}

void Pool::reserve() {
    if (S_.rows() >= size()) return;
    const Index capacity = std::max(size(), std::min(largest_, std::max<Index>(64, size() + size() / 2)));
    S_.conservativeResize(capacity, capacity);
}

TouchedRows::TouchedRows(const Factor& factor, TransposedSolve transposed, const Matrix& B,
                         const ConstraintRows& rows, std::size_t pool_bytes)
    : factor_(factor),
      rows_(rows),
      runs_(B.to_sparse().transpose()),
      pool_(factor, transposed, rows, pool_bytes),
      symmetric_(!transposed),
      u_(factor.size()),
      gap_(B.rows()),
      free_gap_(B.rows()),
      allowance_(B.rows()),
      lambda_(B.rows()) {}

Outcome TouchedRows::solve(const Vector& free, const ConstVectorRef& c, const ConstVectorRef& guess,
                           ContactReport& report, Index most_fresh) {
    free_ = &free;
    const bool open = find_gaps(free, c, free_gap_, [&](Index i, double size) {
        return allowance_[i] = gap_tolerance * (std::abs(c[i]) + size);
    });
    lambda_.setZero();
    violated_.clear();
    if ((guess.array() > 0).any())
        for (Index i = 0; i < c.size(); ++i)
            if (guess[i] > 0 && c[i] != -infinity && !pool_.holds(i)) violated_.push_back(i);
    // What the pool can do comes first: it costs no new columns.
    bool contact = !violated_.empty() || (!open && any_violated_in_pool(c));
    if (!contact && !open) {
        contact = find_violated(c, free_gap_, few);
        // Of the rows that a solution without contact violates a quarter and more are held.
        if (violated_count_ / 4 > most_fresh) return Outcome::iteration_limit;
    }
    touching_ = contact;
    const auto allowed = [this](Index i, double) { return allowance_[i]; };
    for (std::size_t batch = 8 * few; contact; batch *= 2) {
        most_fresh -= static_cast<Index>(violated_.size());
        if (most_fresh < 0) return Outcome::iteration_limit;
        if (pool_.size() + static_cast<Index>(violated_.size()) > pool_.largest()) forget(guess);
        pool_.add(violated_);
        const Outcome outcome = solve_pool(c, guess, report);
        if (outcome != Outcome::converged) return outcome;
        contact = !find_gaps(u_, c, gap_, allowed) && find_violated(c, gap_, batch);
    }
    // A bound is met exactly: a gap of zero then is zero, not rounding.
    for (const Index row : pool_.members())
        if (lambda_[row] > 0 && rows_.columns(row).size() == 1)
            u_[rows_.columns(row)[0]] = c[row] / rows_.weights(row)[0];
    return Outcome::converged;
}

/// gap = B u; whether no row is violated by more than it is allowed, given the row and |B_i||u|.
template <class Allowed>
bool TouchedRows::find_gaps(const Vector& u, const ConstVectorRef& c, Vector& gap, Allowed allowed) const {
    alignas(64) double sum[RowRuns::block_rows], size[RowRuns::block_rows];
    bool open = true;
    for (Index first = 0; first < c.size(); first += RowRuns::block_rows) {
        const Index count = std::min(RowRuns::block_rows, c.size() - first);
        std::fill_n(sum, count, 0.0);
        std::fill_n(size, count, 0.0);
        runs_.add(first / RowRuns::block_rows, 1, u.data(), sum, size);
        const double* bound = c.data() + first;
        std::copy_n(sum, count, gap.data() + first);
        int violated = 0;
        for (Index i = 0; i < count; ++i) violated |= bound[i] - sum[i] > allowed(first + i, size[i]);
        open &= violated == 0;
    }
    return open;
}

bool TouchedRows::any_violated_in_pool(const ConstVectorRef& c) const {
    return std::any_of(pool_.members().begin(), pool_.members().end(),
                       [&](Index i) { return c[i] - free_gap_[i] > allowance_[i]; });
}

/// Rows outside the pool that are violated, the `most` worst of them: a multiplier on these lifts their neighbours.
/// Whether there are any.
bool TouchedRows::find_violated(const ConstVectorRef& c, const Vector& gap, std::size_t most) {
    violated_.clear();
    for (Index i = 0; i < c.size(); ++i)
        if (c[i] - gap[i] > allowance_[i] && !pool_.holds(i)) violated_.push_back(i);
    violated_count_ = static_cast<Index>(violated_.size());
    if (violated_.size() <= most) return !violated_.empty();
    std::nth_element(violated_.begin(), violated_.begin() + static_cast<std::ptrdiff_t>(most), violated_.end(),
                     [&](Index i, Index j) { return c[i] - gap[i] > c[j] - gap[j]; });
    violated_.resize(most);
    std::sort(violated_.begin(), violated_.end());
    return true;
}

/// The pool's contact problem, then u_ = free_ + A^-1 B' lambda_.
Outcome TouchedRows::solve_pool(const ConstVectorRef& c, const ConstVectorRef& guess, ContactReport& report) {
    const Index k = pool_.size();
    reserve(k);
    const bool first = (lambda_.array() == 0).all();
    for (Index i = 0; i < k; ++i) {
        const Index row = pool_.members()[static_cast<std::size_t>(i)];
        g_[i] = c[row] - free_gap_[row];
        pool_allowance_[i] = allowance_[row];
        multiplier_[i] = first ? guess[row] : lambda_[row];
    }
    start_working_set(k);
    for (std::size_t batch = few;; batch *= 2) {
        const auto dense = solve_working_set(k);
        report.iterations += dense.iterations;
        if (dense.repeated) {
            report.set_repeated = true;
            if (symmetric_) report.fallback = "Goldfarb-Idnani";
        }
        if (dense.outcome != Outcome::converged) return dense.outcome;
        if (!widen_working_set(k, batch)) break;
    }
    lambda_.setZero();
    force_.setZero(u_.size());
    for (Index i = 0; i < k; ++i) {
        const Index row = pool_.members()[static_cast<std::size_t>(i)];
        lambda_[row] = multiplier_[i];
        if (multiplier_[i] > 0) rows_.scatter(row, multiplier_[i], force_.data());
    }
    factor_.solve(force_);
    u_ = *free_ + force_;
    return Outcome::converged;
}

/// The rows of the pool that the guess presses on. A pool that has seen many problems holds far more rows than one
/// of them needs, and from a far guess the active set would take all that are violated at first.
void TouchedRows::start_working_set(Index k) {
    working_.clear();
    in_working_set_.assign(static_cast<std::size_t>(k), 0);
    for (Index i = 0; i < k; ++i)
        if (multiplier_[i] > 0) take(i);
    w_.head(k) = -g_.head(k);
    if (working_.empty())
        (void)take_violated(k, few);
    else
        take_all_if_most(k);
}

/// Half the pool or more, or a small pool, is not worth its copy.
void TouchedRows::take_all_if_most(Index k) {
    if (k > small_pool && 2 * static_cast<Index>(working_.size()) < k) return;
    for (Index i = 0; i < k; ++i)
        if (!in_working_set_[static_cast<std::size_t>(i)]) take(i);
}

/// For a pool of k rows.
void TouchedRows::reserve(Index k) {
    if (g_.size() >= k) return;
    const Index capacity = std::max<Index>(k + k / 2, 64);
    for (Vector* v : {&g_, &w_, &multiplier_, &pool_allowance_}) v->resize(capacity);
    for (Vector* v : {&working_g_, &working_allowance_, &working_multiplier_, &working_w_}) v->resize(capacity / 2);
    S_.resize(capacity / 2, capacity / 2);
    working_.reserve(static_cast<std::size_t>(capacity));
    candidates_.reserve(static_cast<std::size_t>(capacity));
    in_working_set_.reserve(static_cast<std::size_t>(capacity));
}

void TouchedRows::take(Index i) {
    working_.push_back(i);
    in_working_set_[static_cast<std::size_t>(i)] = 1;
}

/// The `most` worst of the rows outside that w_ violates; whether there are any.
bool TouchedRows::take_violated(Index k, std::size_t most) {
    candidates_.clear();
    for (Index i = 0; i < k; ++i)
        if (!in_working_set_[static_cast<std::size_t>(i)] && w_[i] < -pool_allowance_[i]) candidates_.push_back(i);
    if (candidates_.size() > most) {
        const auto middle = candidates_.begin() + static_cast<std::ptrdiff_t>(most);
        std::nth_element(candidates_.begin(), middle, candidates_.end(),
                         [&](Index i, Index j) { return w_[i] < w_[j]; });
        candidates_.erase(middle, candidates_.end());
    }
    for (const Index i : candidates_) take(i);
    take_all_if_most(k);
    return !candidates_.empty();
}

CondensedActiveSet::Report TouchedRows::solve_dense(const DenseMatrix& S, const ConstVectorRef& g,
                                                    const ConstVectorRef& allowance, VectorRef lambda, VectorRef w) {
    return symmetric_ ? active_set_.solve(S, g, allowance, lambda, w)
                      : unsymmetric_.solve(S, g, allowance, lambda, w);
}

void TouchedRows::forget_dense() {
    active_set_.forget();
    unsymmetric_.forget();
}

CondensedActiveSet::Report TouchedRows::solve_working_set(Index k) {
    const auto size = static_cast<Index>(working_.size());
    if (size == k) {
        // In the pool's own order, without a copy: a pool that has grown keeps the factor.
        if (!std::exchange(factored_pool_, true)) forget_dense();
        return solve_dense(pool_.S(), g_.head(k), pool_allowance_.head(k), multiplier_.head(k), w_.head(k));
    }
    factored_pool_ = false;
    forget_dense();
    for (Index j = 0; j < size; ++j) {
        const Index row = working_[static_cast<std::size_t>(j)];
        working_g_[j] = g_[row];
        working_allowance_[j] = pool_allowance_[row];
        working_multiplier_[j] = multiplier_[row];
        for (Index i = 0; i < size; ++i) S_(i, j) = pool_.S()(working_[static_cast<std::size_t>(i)], row);
    }
    const auto report = solve_dense(S_, working_g_.head(size), working_allowance_.head(size),
                                    working_multiplier_.head(size), working_w_.head(size));
    for (Index j = 0; j < size; ++j) multiplier_[working_[static_cast<std::size_t>(j)]] = working_multiplier_[j];
    return report;
}

bool TouchedRows::widen_working_set(Index k, std::size_t most) {
    if (static_cast<Index>(working_.size()) == k) return false;
    w_.head(k) = -g_.head(k);
    for (const Index j : working_)
        if (multiplier_[j] > 0) w_.head(k) += multiplier_[j] * pool_.S().col(j).head(k);
    return take_violated(k, most);
}

void TouchedRows::forget(const ConstVectorRef& guess) {
    std::vector<Index> kept;
    for (const Index row : pool_.members())
        if (guess[row] > 0 || lambda_[row] > 0) kept.push_back(row);
    pool_.keep(kept);
    forget_dense();
}

}  // namespace tact
