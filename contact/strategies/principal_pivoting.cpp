#include "principal_pivoting.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <vector>

#include "../../lib/algebra/empty_rows.hpp"
#include "../../lib/sparse/klu_solver.hpp"
#include "../dense/acceptance.hpp"
#include "../prepare/matrix_facts.hpp"
#include "../prepare/rows.hpp"
#include "lemke.hpp"

namespace tact {
namespace {

/// A factor of A found in unknowns of unit stiffness, where pivots say whether A is singular; by powers of two, which round
/// nothing.
class ScaledFactor {
public:
    explicit ScaledFactor(const Matrix& A)
        : unit_(A.main_diagonal().unaryExpr(
              [](double a) { return a > 0 ? std::exp2(std::round(-0.5 * std::log2(a))) : 1.0; })),
          factor_(
              KluSolver().factorize(Matrix(SparseMatrix(unit_.asDiagonal() * A.to_sparse() * unit_.asDiagonal())))) {}
    /// X := A^-1 X.
    void solve(Eigen::Ref<DenseMatrix> X) const {
        X = unit_.asDiagonal() * X;
        factor_->solve(X);
        X = unit_.asDiagonal() * X;
    }

private:
    Vector unit_;
    std::unique_ptr<const Factor> factor_;
};

class PreparedPivoting final : public PreparedContact {
public:
    PreparedPivoting(const Matrix& A, const Matrix& B)
        : A_(A), accept_(A, B), factor_(A), rows_(B), W_(B.to_dense().transpose()) {
        factor_.solve(W_);
        S_ = B.times(W_);
        unit_ = S_.diagonal().unaryExpr([](double s) { return s > 0 ? 1 / std::sqrt(s) : 1.0; });
        Bt_ = SparseMatrix(B.to_sparse().transpose());
        lambda_.resize(B.rows());
        g_.resize(B.rows());
        allowance_.resize(B.rows());
    }

    ContactReport solve(const ConstVectorRef& b, const ConstVectorRef& c, ContactPoint point) override {
        ContactReport report;
        report.strategy = "principal pivoting";
        free_ = b;
        factor_.solve(free_);
        const Index m = g_.size();
        active_.assign(static_cast<std::size_t>(m), 0);
        for (Index i = 0; i < m; ++i) {
            const double own = std::abs(c[i]) + rows_.gather_absolute(i, free_.data());
            g_[i] = c[i] - rows_.gather(i, free_.data());
            allowance_[i] = 2e-14 * own;
            active_[static_cast<std::size_t>(i)] = point.lambda[i] > 0 && c[i] != -infinity;
        }
        if (!pivot_in_blocks(report) && !pivot_by_lemke(c, report)) return report;
        u_ = free_ + W_ * lambda_;
        // Twice: the gaps of the free solution were rounded by its size, not by that of u.
        for (int round = 0; round < 2; ++round) refine(b, c);
        accept_.certify(report, b, c, u_, lambda_, 1e-10, 0, point);
        return report;
    }

private:
    static constexpr Index largest_tableau = 2000;

    /// Exchanges every wrong row at once while that helps, then the least one; false where a block is singular.
    bool pivot_in_blocks(ContactReport& report) {
        const Index m = g_.size();
        Index fewest = m + 1;
        int patience = 3;
        const int limit = 1000 + 20 * static_cast<int>(m);
        for (report.iterations = 1; report.iterations <= limit; ++report.iterations) {
            if (!balance()) return false;
            find_wrong();
            if (wrong_.empty()) return true;
            const Index count = static_cast<Index>(wrong_.size());
            if (count < fewest) {
                fewest = count;
                patience = 3;
            } else {
                --patience;
            }
            if (patience <= 0) wrong_.erase(wrong_.begin() + 1, wrong_.end());  // Murty: the least index alone
            for (const Index i : wrong_) active_[static_cast<std::size_t>(i)] ^= 1;
        }
        return false;
    }

    /// Dependent rows make blocks singular; Lemke's bases avoid them. In units of energy, without the rows that are off.
    bool pivot_by_lemke(const ConstVectorRef& c, ContactReport& report) {
        report.fallback = "Lemke";
        std::vector<Index> on;
        for (Index i = 0; i < c.size(); ++i)
            if (c[i] != -infinity) on.push_back(i);
        if (static_cast<Index>(on.size()) > largest_tableau) {
            report.outcome = Outcome::cycling;
            return false;
        }
        const DenseMatrix scaled = unit_.asDiagonal() * S_ * unit_.asDiagonal();
        const Vector g = unit_.cwiseProduct(g_)(on);
        const DenseMatrix S = scaled(on, on);
        // Where many rows meet in one point rounding decides ties, and may decide for a singular basis: a second and third time
        // the rows are moved apart, and the basis found is that of the rows where they are.
        for (const double apart : {0.0, 1e-9, 1e-6}) {
            const Vector shift = apart * g.lpNorm<Eigen::Infinity>() * Vector::LinSpaced(g.size(), 1, 2).cwiseSqrt();
            const LemkeReport end = lemke(S, g - shift);
            report.iterations += end.pivots;
            report.outcome = end.outcome;
            if (end.outcome == Outcome::infeasible) {
                Vector y = Vector::Zero(c.size());
                for (std::size_t k = 0; k < on.size(); ++k) y[on[k]] = end.ray[static_cast<Index>(k)] * unit_[on[k]];
                if (excludes(y, c)) {
                    report.infeasibility = y / y.maxCoeff();
                    return false;
                }
            } else if (end.outcome == Outcome::converged) {
                std::fill(active_.begin(), active_.end(), char{0});
                for (std::size_t k = 0; k < on.size(); ++k) active_[static_cast<std::size_t>(on[k])] = end.basic[k];
                if (balance() && (lambda_.array() >= -1e-6 * lambda_.lpNorm<Eigen::Infinity>()).all()) {
                    lambda_ = lambda_.cwiseMax(0);
                    return true;
                }
            }
            report.outcome = Outcome::cycling;
        }
        return false;
    }

    /// Whether y >= 0 has B'y = 0 and c'y > 0 beyond rounding, in unknowns of unit stiffness.
    bool excludes(Vector& y, const ConstVectorRef& c) const {
        if (!y.allFinite() || !(y.maxCoeff() > 0)) return false;
        const Vector energy = y.cwiseQuotient(unit_);
        y = (energy.array() > 1e-13 * energy.maxCoeff()).select(y, 0.0);
        return accept_.excludes(y, c);
    }

    /// S(C, C) lambda_C = g_C in units of energy; false if the block is singular.
    bool balance() {
        rows_in_contact_.clear();
        for (Index i = 0; i < g_.size(); ++i)
            if (active_[static_cast<std::size_t>(i)]) rows_in_contact_.push_back(i);
        lambda_.setZero();
        const Index k = static_cast<Index>(rows_in_contact_.size());
        if (k == 0) return true;
        const auto row = [&](Index i) { return rows_in_contact_[static_cast<std::size_t>(i)]; };
        DenseMatrix block(k, k);
        Vector right(k);
        for (Index j = 0; j < k; ++j) {
            right[j] = unit_[row(j)] * g_[row(j)];
            for (Index i = 0; i < k; ++i) block(i, j) = unit_[row(i)] * S_(row(i), row(j)) * unit_[row(j)];
        }
        lu_.compute(block);
        if (!(lu_.rcond() > 1e-15)) return false;
        right = lu_.solve(right).eval();
        for (Index j = 0; j < k; ++j) lambda_[row(j)] = unit_[row(j)] * right[j];
        return lambda_.allFinite();
    }

    /// One step of iterative refinement on the rows in contact, from the data's own residuals.
    void refine(const ConstVectorRef& b, const ConstVectorRef& c) {
        Vector residual = b;
        A_.multiply(u_, residual, -1, 1);
        residual += Bt_ * lambda_;
        factor_.solve(residual);
        const Index k = static_cast<Index>(rows_in_contact_.size());
        Vector right(k);
        for (Index j = 0; j < k; ++j) {
            const Index row = rows_in_contact_[static_cast<std::size_t>(j)];
            right[j] = unit_[row] * (c[row] - rows_.gather(row, u_.data()) - rows_.gather(row, residual.data()));
        }
        if (k > 0) right = lu_.solve(right).eval();
        if (!right.allFinite() || !residual.allFinite()) return;
        u_ += residual;
        for (Index j = 0; j < k; ++j) {
            const Index row = rows_in_contact_[static_cast<std::size_t>(j)];
            const double change = unit_[row] * right[j];
            u_ += change * W_.col(row);
            lambda_[row] = std::max(lambda_[row] + change, 0.0);
        }
    }

    /// Rows with a negative multiplier, or violated without one, in ascending order.
    void find_wrong() {
        wrong_.clear();
        gap_ = S_ * lambda_;
        for (Index i = 0; i < g_.size(); ++i) {
            const double gap = gap_[i] - g_[i];
            if (active_[static_cast<std::size_t>(i)] ? lambda_[i] < 0 : gap < -allowance_[i]) wrong_.push_back(i);
        }
    }

    Matrix A_;
    Acceptance accept_;
    ScaledFactor factor_;
    Eigen::PartialPivLU<DenseMatrix> lu_;  // of the last balance
    ConstraintRows rows_;
    DenseMatrix W_, S_;
    Vector unit_;  // 1/sqrt(S_ii): a row in units of energy
    SparseMatrix Bt_;
    std::vector<char> active_;
    std::vector<Index> wrong_, rows_in_contact_;
    Vector free_, u_, g_, gap_, allowance_, lambda_;
};

}  // namespace

std::unique_ptr<PreparedContact> PrincipalPivoting::prepare(const Matrix& A, const Matrix& B) const {
    check_contact_matrices("PrincipalPivoting", A, B);
    if (has_empty_rows(B)) return prepare_without_empty_rows(*this, A, B);
    check_no_negative_diagonal("PrincipalPivoting", A);
    if (B.rows() > 6000) throw InputError("PrincipalPivoting: B is " + B.shape() + ", expected at most 6000 rows");
    return std::make_unique<PreparedPivoting>(A, B);
}

}  // namespace tact
