#include "tact/contact/schur_contact.hpp"

#include <algorithm>
#include <cmath>

#include "tact/contact/dense/active_set.hpp"
#include "tact/contact/rows.hpp"
#include "tact/lib/linear_solver.hpp"
#include "tact/lib/sparse/cholmod_solver.hpp"

namespace tact {
namespace {

/// The touched rows and S = B A^-1 B' among them.
class Pool {
public:
    Pool(const Factor& factor, const ConstraintRows& rows) : factor_(factor), rows_(rows) {
        place_.assign(static_cast<std::size_t>(rows.rows()), -1);
    }
    Index size() const { return static_cast<Index>(members_.size()); }
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
        const Index capacity = std::max<Index>(64, size() + size() / 2);
        S_.conservativeResize(capacity, capacity);
    }
    const Factor& factor_;
    const ConstraintRows& rows_;
    std::vector<Index> members_, place_;
    DenseMatrix S_, columns_;
};

class PreparedSchur final : public PreparedContact {
public:
    PreparedSchur(const Matrix& A, const Matrix& B, const LinearSolver& linear, SchurOptions options)
        : options_(options),
          factor_(linear.factorize(A)),
          certificate_(A, B),
          rows_(B),
          pool_(*factor_, rows_),
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
        }
        const Index m = rows_.rows();
        const double size = gaps_of_free_solution(c);
        lambda_.setZero();
        u_ = free_;
        violated_.clear();
        for (Index i = 0; i < m; ++i)
            if (point.lambda[i] > 0 && c[i] != -infinity && !pool_.holds(i)) violated_.push_back(i);
        if (violated_.empty()) find_violated(c, 8);
        bool contact = !violated_.empty() || any_violated_in_pool(c);
        for (std::size_t batch = 16; contact; batch *= 2) {
            if (pool_.size() + static_cast<Index>(violated_.size()) > options_.largest_pool) forget(point.lambda);
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
        certify(report, certificate_, b, c, u_, lambda_, acceptable, size, point);
        return report;
    }

private:
    static constexpr double acceptable = 1e-10;
    /// Of the row's own |c_i| + |B_i||u|: two digits above the rounding of a solve.
    static constexpr double gap_tolerance = 2e-14;

    /// gap_ = B free_, and what of a violation each row is allowed; returns the size of the gaps.
    double gaps_of_free_solution(const ConstVectorRef& c) {
        double size = 0;
        for (Index i = 0; i < c.size(); ++i) {
            gap_[i] = rows_.gather(i, free_.data());
            const double own = std::abs(c[i]) + rows_.gather_absolute(i, free_.data());
            allowance_[i] = gap_tolerance * own;
            if (c[i] != -infinity) size = std::max(size, own);
        }
        return size;
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
        for (Vector* v : {&g_, &w_, &multiplier_, &pool_allowance_})
            if (v->size() < k) v->resize(std::max<Index>(2 * k, 64));
        const bool first = (lambda_.array() == 0).all();
        for (Index i = 0; i < k; ++i) {
            const Index row = pool_.members()[static_cast<std::size_t>(i)];
            g_[i] = c[row] - gap_[row];
            pool_allowance_[i] = allowance_[row];
            multiplier_[i] = first ? guess[row] : lambda_[row];
        }
        const auto dense =
            active_set_.solve(pool_.S(), g_.head(k), pool_allowance_.head(k), multiplier_.head(k), w_.head(k));
        report.iterations += dense.iterations;
        if (dense.repeated) {
            report.set_repeated = true;
            report.fallback = "Goldfarb-Idnani";
        }
        if (dense.outcome != Outcome::converged) return dense.outcome;
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

    void forget(const ConstVectorRef& guess) {
        std::vector<Index> kept;
        for (const Index row : pool_.members())
            if (guess[row] > 0 || lambda_[row] > 0) kept.push_back(row);
        pool_.keep(kept);
    }

    SchurOptions options_;
    std::unique_ptr<const Factor> factor_;
    KktCertificate certificate_;
    ConstraintRows rows_;
    Pool pool_;
    CondensedActiveSet active_set_;
    std::vector<Index> violated_;
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
