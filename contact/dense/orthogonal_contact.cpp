#include "orthogonal_contact.hpp"

#include <Eigen/Cholesky>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "../../lib/algebra/empty_rows.hpp"
#include "acceptance.hpp"
#include "orthogonal_factor.hpp"

namespace tact {
namespace {

/// A = L L' for dense or sparse A (then with a fill-reducing order, which is part of L here).
class Root {
public:
    explicit Root(const Matrix& A) {
        bool definite;
        if (A.dense()) {
            dense_.compute(*A.dense());
            definite = dense_.info() == Eigen::Success &&
                       pivots_are_sound(dense_.matrixLLT().diagonal(), A.dense()->diagonal());
        } else {
            sparse_.compute(A.to_sparse());
            is_sparse_ = true;
            definite =
                sparse_.info() == Eigen::Success && pivots_are_sound(SparseMatrix(sparse_.matrixL()).diagonal(),
                                                                     sparse_.permutationP() * A.main_diagonal());
        }
        if (!definite)
            throw NumericalError("OrthogonalContact: A is " + A.shape() + " and not positive definite to rounding");
    }
    /// x := L^-1 x.
    void lower(Vector& x) const {
        if (!is_sparse_) return dense_.matrixL().solveInPlace(x);
        x = sparse_.permutationP() * x;
        sparse_.matrixL().solveInPlace(x);
    }
    /// x := L^-T x.
    void upper(Vector& x) const {
        if (!is_sparse_) return dense_.matrixU().solveInPlace(x);
        sparse_.matrixU().solveInPlace(x);
        x = sparse_.permutationPinv() * x;
    }

private:
    /// None has shrunk to rounding of its diagonal entry, however the unknowns are scaled.
    static bool pivots_are_sound(const Vector& pivots, const Vector& diagonal) {
        const double rounding = static_cast<double>(pivots.size()) * std::numeric_limits<double>::epsilon();
        return (pivots.array().square() > rounding * diagonal.array()).all();
    }
    bool is_sparse_ = false;
    Eigen::LLT<DenseMatrix> dense_;
    Eigen::SimplicialLLT<SparseMatrix, Eigen::Lower, Eigen::AMDOrdering<long>> sparse_;
};

class PreparedOrthogonal final : public PreparedContact {
public:
    PreparedOrthogonal(const Matrix& A, const Matrix& B)
        : accept_(A, B),
          A_(A),
          root_(A),
          Bt_(B.to_sparse().transpose()),
          absolute_(Bt_.cwiseAbs()),
          factor_(A.rows()),
          length_(B.rows()),
          weight_(B.rows()) {
        // Unknowns in units of their stiffness: what follows does not depend on how they are scaled.
        stiffness_ = A.main_diagonal().cwiseSqrt();
        for (Index i = 0; i < length_.size(); ++i) {
            length_[i] = weight_[i] = 0;
            for (SparseMatrix::InnerIterator it(absolute_, i); it; ++it) {
                const double entry = it.value() / stiffness_[it.row()];
                length_[i] += entry * entry;
                weight_[i] += entry;
            }
            length_[i] = std::sqrt(length_[i]);
        }
        multiplier_.resize(A.rows() + 1);
        for (Vector* v : {&h_, &z_}) v->resize(A.rows());
    }

    ContactReport solve(const ConstVectorRef& b, const ConstVectorRef& c, ContactPoint point) override {
        ContactReport report;
        report.strategy = "orthogonal Goldfarb-Idnani";
        const Index m = length_.size();
        lambda_ = Vector::Zero(m);
        free_ = b;
        root_.lower(free_);
        u_ = free_;
        root_.upper(u_);
        free_reach_ = accept_.reach(u_);
        start_from(point.lambda, c);
        forgiven_ = Vector::Zero(m);
        state_.assign(static_cast<std::size_t>(m), State::open);
        for (const Index i : rows_) state_[static_cast<std::size_t>(i)] = State::active;
        const long limit = 20 * (A_.rows() + m) + 1000;
        for (Index q = most_violated(c); q >= 0; q = most_violated(c)) {
            report.outcome = enter(q, c, limit, report);
            if (report.outcome != Outcome::converged) return report;
            if (report.iterations % 32 == 0) balance(c);
        }
        balance(c);
        for (int pass = 0; pass < 2; ++pass) refine(b, c);
        for (Index i = 0; i < factor_.size(); ++i)
            lambda_[rows_[static_cast<std::size_t>(i)]] = std::max(multiplier_[i], 0.0);
        for (const Index i : rows_)  // A bound is met exactly.
            if (lambda_[i] > 0 && Bt_.col(i).nonZeros() == 1) {
                const SparseMatrix::InnerIterator entry(Bt_, i);
                u_[entry.index()] = c[i] / entry.value();
            }
        accept_.certify(report, b, c, u_, lambda_, acceptable, free_reach_, point);
        return report;
    }

private:
    static constexpr double acceptable = 1e-9;
    static constexpr double dependence = 1e-9;      // of a row's length, after two projections
    static constexpr double gap_tolerance = 1e-13;  // of the row's own |c_i| + |B_i||u|
    enum class State : char { open, active };

    /// Solves on the rows in the factor: t = R^-T (c_C - D'y_free), y = y_free + Q t, lambda_C = R^-1 t.
    void balance(const ConstVectorRef& c) {
        const Index k = factor_.size();
        u_ = free_;
        root_.upper(u_);
        for (Index i = 0; i < k; ++i) {
            const Index row = rows_[static_cast<std::size_t>(i)];
            multiplier_[i] = c[row] - Bt_.col(row).dot(u_);
        }
        factor_.solve_transposed(multiplier_.head(k));
        y_ = free_;
        y_.noalias() += factor_.Q() * multiplier_.head(k);
        factor_.solve(multiplier_.head(k));
    }

    /// One step of iterative refinement of u and the multipliers on the final set, from the data's own residuals.
    void refine(const ConstVectorRef& b, const ConstVectorRef& c) {
        const Index k = factor_.size();
        u_ = y_;
        root_.upper(u_);
        residual_ = b;
        A_.multiply(u_, residual_, -1, 1);
        for (Index i = 0; i < k; ++i) residual_ += multiplier_[i] * Bt_.col(rows_[static_cast<std::size_t>(i)]);
        root_.lower(residual_);
        change_ = residual_;
        Vector shift = residual_;
        root_.upper(shift);
        h_.resize(std::max(h_.size(), k));
        for (Index i = 0; i < k; ++i) {
            const Index row = rows_[static_cast<std::size_t>(i)];
            h_[i] = c[row] - Bt_.col(row).dot(u_) - Bt_.col(row).dot(shift);
        }
        factor_.solve_transposed(h_.head(k));
        change_.noalias() += factor_.Q() * h_.head(k);
        factor_.solve(h_.head(k));
        multiplier_.head(k) += h_.head(k);
        y_ += change_;
        u_ = y_;
        root_.upper(u_);
    }

    void start_from(const ConstVectorRef& lambda, const ConstVectorRef& c) {
        factor_.clear();
        rows_.clear();
        for (Index i = 0; i < lambda.size(); ++i) {
            if (!(lambda[i] > 0) || c[i] == -infinity) continue;
            const double norm = split(i);
            if (norm > dependence * row_.norm()) take(i, norm);
        }
        balance(c);
        // Any set with multipliers >= 0 is a valid start.
        while (factor_.size() > 0) {
            const Index k = factor_.size();
            if (multiplier_.head(k).minCoeff() >= 0) break;
            for (Index i = k - 1; i >= 0; --i)
                if (!(multiplier_[i] >= 0)) drop(i);  // what overflowed, too
            balance(c);
        }
    }

    /// row_ = L^-1 B_q' = Q h + z.
    double split(Index q) {
        row_ = Bt_.col(q);
        root_.lower(row_);
        return factor_.split(row_, h_, z_);
    }
    void take(Index q, double norm) {
        factor_.append(h_, z_, norm);
        rows_.push_back(q);
    }
    void drop(Index place) {
        const Index k = factor_.size();
        factor_.remove(place);
        rows_.erase(rows_.begin() + place);
        std::copy(multiplier_.data() + place + 1, multiplier_.data() + k, multiplier_.data() + place);
    }

    Index most_violated(const ConstVectorRef& c) {
        u_ = y_;
        root_.upper(u_);
        size_ = u_.cwiseAbs();
        // u carries rounding of its largest entry everywhere, also where it is small.
        const double noise = 4e-15 * accept_.reach(u_);
        Index worst = -1;
        double depth = 0;
        for (Index i = 0; i < c.size(); ++i) {
            if (state_[static_cast<std::size_t>(i)] != State::open || c[i] == -infinity) continue;
            const double gap = Bt_.col(i).dot(u_) - c[i];
            if (gap >= 0) continue;
            const double rounding =
                gap_tolerance * (std::abs(c[i]) + absolute_.col(i).dot(size_)) + noise * weight_[i];
            if (gap >= -std::max(rounding, forgiven_[i])) continue;
            const double violation = length_[i] > 0 ? -gap / length_[i] : infinity;
            if (violation > depth) {
                depth = violation;
                worst = i;
            }
        }
        return worst;
    }

    /// Brings row q to its boundary, or finds that nothing can.
    Outcome enter(Index q, const ConstVectorRef& c, long limit, ContactReport& report) {
        double multiplier_q = 0;
        double gap_q = Bt_.col(q).dot(u_) - c[q];
        while (true) {
            if (++report.iterations > limit) return Outcome::iteration_limit;
            const Index k = factor_.size();
            const double norm = split(q);
            const bool dependent = !(norm > dependence * row_.norm());
            Vector& r = change_;
            r = h_.head(k);
            factor_.solve(r);
            const double full_step = dependent ? infinity : -gap_q / (norm * norm);
            double partial_step = infinity;
            Index leaving = -1;
            const double noise = 1e-12 * r.lpNorm<Eigen::Infinity>();  // not a direction in which a multiplier falls
            for (Index i = 0; i < k; ++i)
                if (r[i] > noise && multiplier_[i] < partial_step * r[i]) {
                    partial_step = multiplier_[i] / r[i];
                    leaving = i;
                }
            const double step = std::min(full_step, partial_step);
            if (step == infinity) return nothing_moves(q, r, c, report);
            multiplier_.head(k) -= step * r;
            multiplier_q += step;
            if (!dependent) {
                y_ += step * z_;
                gap_q += step * norm * norm;
            }
            if (full_step <= partial_step) {
                take(q, norm);
                multiplier_[k] = multiplier_q;
                state_[static_cast<std::size_t>(q)] = State::active;
                return Outcome::converged;
            }
            state_[static_cast<std::size_t>(rows_[static_cast<std::size_t>(leaving)])] = State::open;
            drop(leaving);
        }
    }

    /// Row q depends on the active ones with multipliers that can only grow: infeasible if y = e_q - r says so beyond
    /// rounding, else the row is met as well as rounding allows.
    Outcome nothing_moves(Index q, const Vector& r, const ConstVectorRef& c, ContactReport& report) {
        Vector y = Vector::Zero(c.size());
        y[q] = 1;
        for (Index i = 0; i < r.size(); ++i) y[rows_[static_cast<std::size_t>(i)]] = std::max(-r[i], 0.0);
        // B'y vanishes to rounding only: it says nothing against a u that rounding of this size could satisfy.
        double value = 0;
        for (Index i = 0; i < y.size(); ++i)
            if (y[i] > 0) value += y[i] * c[i];
        const Vector rest = Bt_ * y;
        if (value > 10 * rest.cwiseAbs().dot(u_.cwiseAbs()) && accept_.excludes(y, c)) {
            report.infeasibility = y / y.maxCoeff();
            return Outcome::infeasible;
        }
        balance(c);
        u_ = y_;
        root_.upper(u_);
        const double violation = c[q] - Bt_.col(q).dot(u_);
        if (violation > acceptable * (std::abs(c[q]) + absolute_.col(q).dot(u_.cwiseAbs())))
            return Outcome::inaccurate;
        forgiven_[q] = 10 * std::abs(violation);
        return Outcome::converged;
    }

    Acceptance accept_;
    Matrix A_;
    Root root_;
    SparseMatrix Bt_, absolute_;  // column i: row i of B, and its absolute values
    OrthogonalFactor factor_;
    std::vector<Index> rows_;
    std::vector<State> state_;
    double free_reach_ = 0;
    Vector forgiven_;  // by how much a row that depends on the active ones is left violated, to rounding
    Vector stiffness_, length_, weight_, multiplier_, free_, y_, u_, lambda_, row_, h_, z_, change_, residual_, size_;
};

}  // namespace

std::unique_ptr<PreparedContact> OrthogonalContact::prepare(const Matrix& A, const Matrix& B) const {
    check_contact_matrices("OrthogonalContact", A, B);
    if (has_empty_rows(B)) return prepare_without_empty_rows(*this, A, B);
    if (!A.is_symmetric()) throw InputError("OrthogonalContact: A is " + A.shape() + " and not symmetric");
    return std::make_unique<PreparedOrthogonal>(A, B);
}

}  // namespace tact
