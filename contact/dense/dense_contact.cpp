#include "dense_contact.hpp"

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "../../lib/algebra/empty_rows.hpp"
#include "../../lib/algebra/linear_solver.hpp"
#include "acceptance.hpp"
#include "few_rows.hpp"
#include "goldfarb_idnani.hpp"

namespace tact {
namespace {

class PreparedDense final : public PreparedContact {
public:
    PreparedDense(const Matrix& A, const Matrix& B, const DenseContactOptions& options)
        : B_(B),
          options_(options),
          accept_(A, B),
          u_(A.rows()),
          g_(B.rows()),
          w_(B.rows()),
          multiplier_(B.rows()),
          lambda_(B.rows()) {
        take(A, DenseLinearSolver().factorize(A));
    }

    bool update(const Matrix& given) override {
        const Matrix A = given.sparse() ? Matrix(given.to_dense()) : given;
        if (A.rows() != u_.size() || A.cols() != u_.size() || !A.is_symmetric()) return false;
        if (const Vector* d = A.diagonal_entries(); d && !(d->minCoeff() > 0)) return false;
        auto factor = DenseLinearSolver().factorize(A);
        accept_ = Acceptance(A, B_);
        dual_.reset();
        take(A, std::move(factor));
        return true;
    }

    ContactReport solve(const ConstVectorRef& b, const ConstVectorRef& c, ContactPoint point) override {
        ContactReport report;
        report.strategy = "dense Goldfarb-Idnani";
        solve_freely(b);
        if (few_ && few_->solve(report, b, c, u_, point, sharp)) return report;
        report = {};
        report.strategy = "dense Goldfarb-Idnani";
        const Index m = g_.size();
        if (m > 0 && rows_.S.size() == 0) {
            if (m > formed_at_all) {
                report.outcome = Outcome::inaccurate;
                return report;
            }
            few_.reset();  // what it knows of the rows in play was formed without S
            form_condensed();
        }
        solve_freely(b);
        double gap_size = 0, reach = 0;
        bool doubtful = false;  // rows were left violated by what may be rounding
        if (m > 0) {
            w_ = c.cwiseProduct(rows_.scale);
            g_.noalias() = rows_.B * u_;
            const double largest = (w_ - g_).maxCoeff();  // violation, in energy units
            if (!(largest <= 0) || (point.lambda.array() > 0).any()) {
                allowance_ = CondensedRows::gap_tolerance * (g_.cwiseAbs() + w_.cwiseAbs());
                gap_size = (w_.array() == -infinity)
                               .select(0, w_.cwiseAbs().cwiseMax(g_.cwiseAbs()).cwiseQuotient(rows_.scale))
                               .maxCoeff();
                reach = accept_.reach(u_);
                g_ = w_ - g_;
                // A row that is switched off may have carried a force when it was guessed.
                multiplier_ = (c.array() == -infinity).select(0, point.lambda.cwiseQuotient(rows_.scale));
                const auto dual = dual_.solve(rows_.S, g_, allowance_, multiplier_, w_);
                report.iterations = dual.iterations;
                report.outcome = dual.outcome;
                if (dual.outcome == Outcome::infeasible) {
                    report.infeasibility = dual_.infeasibility().cwiseProduct(rows_.scale);
                    if (!accept_.excludes(report.infeasibility, c)) {
                        report.infeasibility.resize(0);
                        report.outcome = Outcome::inaccurate;
                        return report;
                    }
                    report.infeasibility /= report.infeasibility.maxCoeff();
                }
                if (dual.outcome != Outcome::converged) return report;
                for (const Index i : dual_.factor().rows()) {
                    if (multiplier_[i] == 0) continue;
                    u_ += multiplier_[i] * rows_.W.col(i);
                }
                // A bound is met exactly: a gap of zero then is zero, not rounding.
                for (const auto& [row, column, weight] : rows_.bounds)
                    if (multiplier_[row] > 0) u_[column] = c[row] / weight;
                lambda_ = multiplier_.cwiseProduct(rows_.scale);
                doubtful = dual_.forgave();
            } else {
                lambda_.setZero();
            }
        }
        if (rows_.compliance.size() > 0) w_ = c - rows_.compliance.cwiseProduct(lambda_);
        const ConstVectorRef bound = rows_.compliance.size() > 0 ? ConstVectorRef(w_) : c;
        // NaN in b or c ends here, as does an A that is singular in all but name.
        if (!doubtful) certify(report, accept_.residuals(), b, bound, u_, lambda_, sharp, gap_size, point);
        if (!doubtful && report.outcome == Outcome::converged) return report;
        report.outcome = Outcome::converged;
        accept_.certify(report, b, bound, u_, lambda_, acceptable, reach, point);
        return report;
    }

private:
    void take(const Matrix& A, std::unique_ptr<const Factor> factor) {
        few_.reset();
        factor_ = std::move(factor);
        inverse_.resize(0);
        if (const Vector* d = A.diagonal_entries()) inverse_ = d->cwiseInverse();
        rows_ = {};
        const DenseMatrix dense_B = B_.to_dense();
        rows_.W = dense_B.transpose();
        factor_->solve(rows_.W);
        // Rows of unit energy: the answer does not depend on how a row of B is scaled.
        for (Index i = 0; i < dense_B.rows(); ++i) {
            Index column = 0;
            if ((dense_B.row(i).array() != 0).count() != 1) continue;
            dense_B.row(i).cwiseAbs().maxCoeff(&column);
            rows_.bounds.push_back({i, column, dense_B(i, column)});
        }
        rows_.scale = dense_B.cwiseProduct(rows_.W.transpose()).rowwise().sum();
        for (double& s : rows_.scale) s = s > 0 ? 1 / std::sqrt(s) : 1;
        rows_.B = rows_.scale.asDiagonal() * dense_B;
        rows_.W = rows_.W * rows_.scale.asDiagonal();
        const Vector own = rows_.B.cwiseProduct(rows_.W.transpose()).rowwise().sum();
        if (options_.compliance > 0) {
            rows_.compliance = options_.compliance * own.cwiseQuotient(rows_.scale.cwiseAbs2());
            rows_.bounds.clear();  // rows give way: none is met exactly
        }
        const bool many = B_.rows() > formed_at_once;
        if (!many) form_condensed();
        constexpr Index fewest = 8;  // rows, for leaving some out to pay
        if (many || (options_.screening && inverse_.size() > 0 && B_.rows() >= fewest))
            few_.emplace(A, dense_B, rows_);
    }

    static constexpr double acceptable = 1e-9;
    /// Beyond this rows are judged one by one: the largest of them may hide what is wrong in the others.
    static constexpr double sharp = 1e-12;

    /// Rows up to which S is formed when (A, B) is prepared, and up to which it is where a solve on few of them fails.
    static constexpr Index formed_at_once = 1200, formed_at_all = 4000;

    void form_condensed() {
        rows_.S = rows_.B * rows_.W;
        rows_.S = (0.5 * (rows_.S + rows_.S.transpose())).eval();
        if (rows_.compliance.size() > 0) rows_.S.diagonal() += rows_.compliance.cwiseProduct(rows_.scale.cwiseAbs2());
    }

    /// u = A^-1 b
    void solve_freely(const ConstVectorRef& b) {
        if (inverse_.size() > 0) {
            u_ = inverse_.cwiseProduct(b);
        } else {
            u_ = b;
            factor_->solve(u_);
        }
    }

    Matrix B_;
    DenseContactOptions options_;
    CondensedRows rows_;
    Acceptance accept_;
    std::optional<FewRows> few_;
    std::unique_ptr<const Factor> factor_;
    Vector inverse_;  // of A's diagonal, where it is diagonal
    GoldfarbIdnani dual_;
    Vector u_, g_, w_, allowance_, multiplier_, lambda_;
};

}  // namespace

std::unique_ptr<PreparedContact> DenseContact::prepare(const Matrix& A, const Matrix& B) const {
    check_contact_matrices("DenseContact", A, B);
    if (has_empty_rows(B)) return prepare_without_empty_rows(*this, A, B);
    if (!(options_.compliance >= 0) || options_.compliance == infinity)
        throw InputError("DenseContact: compliance is " + shown(options_.compliance) +
                         ", expected a finite number >= 0");
    if (!A.is_symmetric()) throw InputError("DenseContact: A is " + A.shape() + " and not symmetric");
    if (const Vector* diagonal = A.diagonal_entries(); diagonal && !(diagonal->minCoeff() > 0))
        throw NumericalError("DenseContact: A has a diagonal entry <= 0, expected positive definite");
    if (A.sparse()) {
        if (A.rows() > 2000)
            throw InputError("DenseContact: A is " + A.shape() +
                             ", expected dense, diagonal or at most 2000 unknowns");
        return std::make_unique<PreparedDense>(Matrix(A.to_dense()), B, options_);
    }
    return std::make_unique<PreparedDense>(A, B, options_);
}

}  // namespace tact
