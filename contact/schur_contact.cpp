#include "tact/contact/schur_contact.hpp"

#include <algorithm>
#include <cmath>

#include "tact/contact/dense/acceptance.hpp"
#include "tact/contact/dense/active_set.hpp"
#include "tact/contact/rows.hpp"
#include "tact/lib/linear_solver.hpp"
#include "tact/lib/sparse/cholmod_solver.hpp"

namespace tact {
namespace {

/// The touched rows and S = B A^-1 B' among them.
class Pool {
public:
    Pool(const Factor& factor, const ConstraintRows& rows, std::size_t bytes)
        : factor_(factor),
          rows_(rows),
          largest_(static_cast<Index>(std::sqrt(static_cast<double>(bytes) / sizeof(double)))) {
        place_.assign(static_cast<std::size_t>(rows.rows()), -1);
    }
    Index size() const { return static_cast<Index>(members_.size()); }
    /// Rows that the bytes allowed hold.
    Index largest() const { return largest_; }
    const std::vector<Index>& members() const { return members_; }
    bool holds(Index row) const { return place_[static_cast<std::size_t>(row)] >= 0; }
    const DenseMatrix& S() const { return S_; }

    void add(const std::vector<Index>& fresh) {
        constexpr std::size_t batch = 32;  // right-hand sides that fill the factor's BLAS-3 solve
        for (std::size_t first = 0; first < fresh.size(); first += batch) {
            const auto last = std::min(first + batch, fresh.size());
            const Index old = size();
            columns_.setZero(factor_.size(), static_cast<Index>(last - first));
            for (auto k = first; k < last; ++k) {
                place_[static_cast<std::size_t>(fresh[k])] = size();
                members_.push_back(fresh[k]);
                rows_.scatter(fresh[k], 1, columns_.col(static_cast<Index>(k - first)).data());
            }
            factor_.solve(columns_);
            reserve();
            for (Index j = 0; j < columns_.cols(); ++j)
                for (Index i = 0; i <= old + j; ++i) {
                    const double s = rows_.gather(members_[static_cast<std::size_t>(i)], columns_.col(j).data());
                    S_(i, old + j) = s;
                    S_(old + j, i) = s;
                }
        }
    }

    /// Forgets all rows but those given; their mutual compliance is kept.
    void keep(const std::vector<Index>& rows) {
        DenseMatrix kept(static_cast<Index>(rows.size()), static_cast<Index>(rows.size()));
        for (Index j = 0; j < kept.cols(); ++j)
            for (Index i = 0; i < kept.rows(); ++i)
                kept(i, j) = S_(place_[static_cast<std::size_t>(rows[static_cast<std::size_t>(i)])],
                                place_[static_cast<std::size_t>(rows[static_cast<std::size_t>(j)])]);
        for (const Index row : members_) place_[static_cast<std::size_t>(row)] = -1;
        members_ = rows;
        for (Index i = 0; i < kept.rows(); ++i)
            place_[static_cast<std::size_t>(rows[static_cast<std::size_t>(i)])] = i;
        S_ = std::move(kept);
    }

private:
    void reserve() {
        if (S_.rows() >= size()) return;
        const Index capacity = std::max(size(), std::min(largest_, std::max<Index>(64, size() + size() / 2)));
        S_.conservativeResize(capacity, capacity);
    }
    const Factor& factor_;
    const ConstraintRows& rows_;
    Index largest_;
    std::vector<Index> members_, place_;
    DenseMatrix S_, columns_;
};

class PreparedSchur final : public PreparedContact {
public:
    PreparedSchur(const Matrix& A, const Matrix& B, const LinearSolver& linear, SchurOptions options)
        : factor_(linear.factorize(A)),
          accept_(A, B),
          rows_(B),
          pool_(*factor_, rows_, options.pool_bytes),
          free_(A.rows()),
          u_(A.rows()),
          gap_(B.rows()),
          allowance_(B.rows()),
          lambda_(B.rows()) {}

    ContactReport solve(const ConstVectorRef& b, const ConstVectorRef& c, ContactPoint point) override {
        ContactReport report;
        report.strategy = "Schur complement";
        if (load_.size() != b.size() || load_ != b) {
            free_ = b;
            factor_->solve(free_);
            load_ = b;
            reach_ = accept_.reach(free_);
        }
        const Index m = rows_.rows();
        gaps_of_free_solution(c);
        lambda_.setZero();
        u_ = free_;
        violated_.clear();
        for (Index i = 0; i < m; ++i)
            if (point.lambda[i] > 0 && c[i] != -infinity && !pool_.holds(i)) violated_.push_back(i);
        // What the pool can do comes first: it costs no new columns.
        bool contact = !violated_.empty() || any_violated_in_pool(c);
        if (!contact) {
            find_violated(c, few);
            contact = !violated_.empty();
        }
        for (std::size_t batch = 2 * few; contact; batch *= 2) {
            if (pool_.size() + static_cast<Index>(violated_.size()) > pool_.largest()) forget(point.lambda);
            pool_.add(violated_);
            report.outcome = solve_pool(c, point.lambda, report);
            if (report.outcome != Outcome::converged) return report;
            violated_.clear();
            find_violated(c, batch);
            contact = !violated_.empty();
        }
        // A bound is met exactly: a gap of zero then is zero, not rounding.
        for (const Index row : pool_.members())
            if (lambda_[row] > 0 && rows_.columns(row).size() == 1)
                u_[rows_.columns(row)[0]] = c[row] / rows_.weights(row)[0];
        accept_.certify(report, b, c, u_, lambda_, acceptable, reach_, point);
        return report;
    }

private:
    static constexpr double acceptable = 1e-10;
    static constexpr Index small_pool = 100;
    static constexpr std::size_t few = 8;  ///< rows that are taken at once when nothing is known yet
    /// Of the row's own |c_i| + |B_i||u|: two digits above the rounding of a solve.
    static constexpr double gap_tolerance = 2e-14;

    /// gap_ = B free_, and what of a violation each row is allowed.
    void gaps_of_free_solution(const ConstVectorRef& c) {
        for (Index i = 0; i < c.size(); ++i) {
            gap_[i] = rows_.gather(i, free_.data());
            const double own = std::abs(c[i]) + rows_.gather_absolute(i, free_.data());
            allowance_[i] = gap_tolerance * own;
        }
    }

    bool any_violated_in_pool(const ConstVectorRef& c) const {
        return std::any_of(pool_.members().begin(), pool_.members().end(),
                           [&](Index i) { return c[i] - gap_[i] > allowance_[i]; });
    }

    /// Rows outside the pool that u_ violates, the `most` worst of them: a multiplier on these lifts their neighbours.
    void find_violated(const ConstVectorRef& c, std::size_t most) {
        for (Index i = 0; i < c.size(); ++i)
            if (!pool_.holds(i) && c[i] - rows_.gather(i, u_.data()) > allowance_[i]) violated_.push_back(i);
        if (violated_.size() <= most) return;
        const auto deeper = [&](Index i, Index j) {
            return c[i] - rows_.gather(i, u_.data()) > c[j] - rows_.gather(j, u_.data());
        };
        std::nth_element(violated_.begin(), violated_.begin() + static_cast<std::ptrdiff_t>(most), violated_.end(),
                         deeper);
        violated_.resize(most);
        std::sort(violated_.begin(), violated_.end());
    }

    /// The pool's contact problem, then u_ = free_ + A^-1 B' lambda_.
    Outcome solve_pool(const ConstVectorRef& c, const ConstVectorRef& guess, ContactReport& report) {
        const Index k = pool_.size();
        reserve(k);
        const bool first = (lambda_.array() == 0).all();
        for (Index i = 0; i < k; ++i) {
            const Index row = pool_.members()[static_cast<std::size_t>(i)];
            g_[i] = c[row] - gap_[row];
            pool_allowance_[i] = allowance_[row];
            multiplier_[i] = first ? guess[row] : lambda_[row];
        }
        start_working_set(k);
        for (std::size_t batch = few;; batch *= 2) {
            const auto dense = solve_working_set(k);
            report.iterations += dense.iterations;
            if (dense.repeated) {
                report.set_repeated = true;
                report.fallback = "Goldfarb-Idnani";
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
        factor_->solve(force_);
        u_ = free_ + force_;
        return Outcome::converged;
    }

    /// The rows of the pool that the guess presses on. A pool that has seen many problems holds far more rows than one
    /// of them needs, and from a far guess the active set would take all that are violated at first.
    void start_working_set(Index k) {
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
    void take_all_if_most(Index k) {
        if (k > small_pool && 2 * static_cast<Index>(working_.size()) < k) return;
        for (Index i = 0; i < k; ++i)
            if (!in_working_set_[static_cast<std::size_t>(i)]) take(i);
    }

    /// For a pool of k rows.
    void reserve(Index k) {
        if (g_.size() >= k) return;
        const Index capacity = std::max<Index>(k + k / 2, 64);
        for (Vector* v : {&g_, &w_, &multiplier_, &pool_allowance_}) v->resize(capacity);
        for (Vector* v : {&working_g_, &working_allowance_, &working_multiplier_, &working_w_})
            v->resize(capacity / 2);
        S_.resize(capacity / 2, capacity / 2);
        working_.reserve(static_cast<std::size_t>(capacity));
        candidates_.reserve(static_cast<std::size_t>(capacity));
        in_working_set_.reserve(static_cast<std::size_t>(capacity));
    }

    void take(Index i) {
        working_.push_back(i);
        in_working_set_[static_cast<std::size_t>(i)] = 1;
    }

    /// The `most` worst of the rows outside that w_ violates; whether there are any.
    bool take_violated(Index k, std::size_t most) {
        candidates_.clear();
        for (Index i = 0; i < k; ++i)
            if (!in_working_set_[static_cast<std::size_t>(i)] && w_[i] < -pool_allowance_[i])
                candidates_.push_back(i);
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

    CondensedActiveSet::Report solve_working_set(Index k) {
        const auto size = static_cast<Index>(working_.size());
        if (size == k) {
            // In the pool's own order, without a copy.
            return active_set_.solve(pool_.S(), g_.head(k), pool_allowance_.head(k), multiplier_.head(k), w_.head(k));
        }
        for (Index j = 0; j < size; ++j) {
            const Index row = working_[static_cast<std::size_t>(j)];
            working_g_[j] = g_[row];
            working_allowance_[j] = pool_allowance_[row];
            working_multiplier_[j] = multiplier_[row];
            for (Index i = 0; i < size; ++i) S_(i, j) = pool_.S()(working_[static_cast<std::size_t>(i)], row);
        }
        const auto report = active_set_.solve(S_, working_g_.head(size), working_allowance_.head(size),
                                              working_multiplier_.head(size), working_w_.head(size));
        for (Index j = 0; j < size; ++j) multiplier_[working_[static_cast<std::size_t>(j)]] = working_multiplier_[j];
        return report;
    }

    bool widen_working_set(Index k, std::size_t most) {
        if (static_cast<Index>(working_.size()) == k) return false;
        w_.head(k) = -g_.head(k);
        for (const Index j : working_)
            if (multiplier_[j] > 0) w_.head(k) += multiplier_[j] * pool_.S().col(j).head(k);
        return take_violated(k, most);
    }

    void forget(const ConstVectorRef& guess) {
        std::vector<Index> kept;
        for (const Index row : pool_.members())
            if (guess[row] > 0 || lambda_[row] > 0) kept.push_back(row);
        pool_.keep(kept);
    }

    std::unique_ptr<const Factor> factor_;
    Acceptance accept_;
    ConstraintRows rows_;
    Pool pool_;
    CondensedActiveSet active_set_;
    std::vector<Index> violated_, working_, candidates_;
    std::vector<char> in_working_set_;
    DenseMatrix S_;  // of the working set, as what follows
    Vector working_g_, working_allowance_, working_multiplier_, working_w_;
    double reach_ = 0;  // of free_, in units of energy
    Vector load_, free_, u_, gap_, allowance_, lambda_, pool_allowance_, g_, w_, multiplier_, force_;
};

}  // namespace

SchurContact::SchurContact(SchurOptions options, std::shared_ptr<const LinearSolver> linear)
    : options_(options), linear_(linear ? std::move(linear) : std::make_shared<CholmodSolver>()) {}

std::unique_ptr<PreparedContact> SchurContact::prepare(const Matrix& A, const Matrix& B) const {
    check_contact_matrices("SchurContact", A, B);
    if (!A.is_symmetric())
        throw InputError("SchurContact: A is " + A.shape() + " and not symmetric; use KluActiveSet");
    return std::make_unique<PreparedSchur>(A, B, *linear_, options_);
}

}  // namespace tact
