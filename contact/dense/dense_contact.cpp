#include "tact/contact/dense/dense_contact.hpp"

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "tact/contact/dense/acceptance.hpp"
#include "tact/contact/dense/goldfarb_idnani.hpp"
#include "tact/contact/dense/screened_gaps.hpp"
#include "tact/lib/linear_solver.hpp"

namespace tact {
namespace {

/// A violation counts above this fraction of the row's own |c_i| + |B_i u|, two digits above rounding.
constexpr double gap_tolerance = 2e-14;

class PreparedDense final : public PreparedContact {
public:
    PreparedDense(const Matrix& A, const Matrix& B, const DenseContactOptions& options)
        : accept_(A, B), u_(A.rows()), g_(B.rows()), w_(B.rows()), multiplier_(B.rows()), lambda_(B.rows()) {
        factor_ = DenseLinearSolver().factorize(A);
        if (const Vector* d = A.diagonal_entries()) inverse_ = d->cwiseInverse();
        const DenseMatrix dense_B = B.to_dense();
        W_ = dense_B.transpose();
        factor_->solve(W_);
        // Rows of unit energy: the answer does not depend on how a row of B is scaled.
        for (Index i = 0; i < dense_B.rows(); ++i) {
            Index column = 0;
            if ((dense_B.row(i).array() != 0).count() != 1) continue;
            dense_B.row(i).cwiseAbs().maxCoeff(&column);
            bounds_.push_back({i, column, dense_B(i, column)});
        }
        scale_ = (dense_B * W_).diagonal();
        for (double& s : scale_) s = s > 0 ? 1 / std::sqrt(s) : 1;
        B_ = scale_.asDiagonal() * dense_B;
        W_ = W_ * scale_.asDiagonal();
        S_ = B_ * W_;
        S_ = (0.5 * (S_ + S_.transpose())).eval();
        if (options.compliance > 0) {
            compliance_ = options.compliance * S_.diagonal().cwiseQuotient(scale_.cwiseAbs2());
            S_.diagonal() *= 1 + options.compliance;
            bounds_.clear();  // rows give way: none is met exactly
        }
        if (options.screening && inverse_.size() > 0 && ScreenedGaps::pays(B.rows(), B.cols())) {
            screen_.emplace(B_);
            certificate_of_open_rows_.emplace(A, Matrix(DenseMatrix(0, A.cols())));
        }
    }

    ContactReport solve(const ConstVectorRef& b, const ConstVectorRef& c, ContactPoint point) override {
        ContactReport report;
        report.strategy = "dense Goldfarb-Idnani";
        if (inverse_.size() > 0) {
            u_ = inverse_.cwiseProduct(b);
        } else {
            u_ = b;
            factor_->solve(u_);
        }
        const Index m = g_.size();
        double gap_size = 0, reach = 0;
        bool doubtful = false;  // rows were left violated by what may be rounding
        if (m > 0) {
            w_ = c.cwiseProduct(scale_);
            if (screen_ && (point.lambda.array() == 0).all() && screen_->all_open(u_, w_)) {
                // Open gaps and no multipliers leave stationarity to be certified.
                certify(report, *certificate_of_open_rows_, b, Vector(), u_, Vector(), acceptable, 0,
                        {point.u, point.lambda.head(0)});
                if (report.outcome == Outcome::converged) return report;
                report.outcome = Outcome::converged;
            }
            g_.noalias() = B_ * u_;
            const double largest = (w_ - g_).maxCoeff();  // violation, in energy units
            if (!(largest <= 0) || (point.lambda.array() > 0).any()) {
                allowance_ = gap_tolerance * (g_.cwiseAbs() + w_.cwiseAbs());
                gap_size = (w_.array() == -infinity)
                               .select(0, w_.cwiseAbs().cwiseMax(g_.cwiseAbs()).cwiseQuotient(scale_))
                               .maxCoeff();
                reach = accept_.reach(u_);
                g_ = w_ - g_;
                multiplier_ = point.lambda.cwiseQuotient(scale_);
                const auto dual = dual_.solve(S_, g_, allowance_, multiplier_, w_);
                report.iterations = dual.iterations;
                report.outcome = dual.outcome;
                if (dual.outcome == Outcome::infeasible) {
                    report.infeasibility = dual_.infeasibility().cwiseProduct(scale_);
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
                    u_ += multiplier_[i] * W_.col(i);
                }
                // A bound is met exactly: a gap of zero then is zero, not rounding.
                for (const auto& [row, column, weight] : bounds_)
                    if (multiplier_[row] > 0) u_[column] = c[row] / weight;
                lambda_ = multiplier_.cwiseProduct(scale_);
                doubtful = dual_.forgave();
            } else {
                lambda_.setZero();
            }
        }
        if (compliance_.size() > 0) w_ = c - compliance_.cwiseProduct(lambda_);
        const ConstVectorRef bound = compliance_.size() > 0 ? ConstVectorRef(w_) : c;
        // NaN in b or c ends here, as does an A that is singular in all but name.
        if (!doubtful) certify(report, accept_.residuals(), b, bound, u_, lambda_, acceptable, gap_size, point);
        if (!doubtful && report.outcome == Outcome::converged) return report;
        report.outcome = Outcome::converged;
        accept_.certify(report, b, bound, u_, lambda_, acceptable, reach, point);
        return report;
    }

private:
    static constexpr double acceptable = 1e-9;
    struct Bound {
        Index row, column;
        double weight;
    };
    std::vector<Bound> bounds_;  // the rows of B with one entry
    Acceptance accept_;
    std::optional<ScreenedGaps> screen_;
    std::optional<KktCertificate> certificate_of_open_rows_;  // for points that screening has proven open
    std::unique_ptr<const Factor> factor_;
    Vector compliance_;  // diagonal of E; empty without
    Vector inverse_;     // of A's diagonal, where it is diagonal
    Vector scale_;
    DenseMatrix B_, W_, S_;
    GoldfarbIdnani dual_;
    Vector u_, g_, w_, allowance_, multiplier_, lambda_;
};

}  // namespace

std::unique_ptr<PreparedContact> DenseContact::prepare(const Matrix& A, const Matrix& B) const {
    check_contact_matrices("DenseContact", A, B);
    if (!(options_.compliance >= 0) || options_.compliance == infinity)
        throw InputError("DenseContact: compliance is " + std::to_string(options_.compliance) +
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
