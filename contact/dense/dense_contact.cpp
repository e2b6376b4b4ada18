#include "tact/contact/dense/dense_contact.hpp"

#include <cmath>
#include <string>
#include <vector>

#include "tact/contact/dense/goldfarb_idnani.hpp"
#include "tact/lib/linear_solver.hpp"

namespace tact {
namespace {

/// A violation counts above this fraction of the row's own |c_i| + |B_i u|, two digits above rounding.
constexpr double gap_tolerance = 2e-14;

class PreparedDense final : public PreparedContact {
public:
    PreparedDense(const Matrix& A, const Matrix& B)
        : certificate_(A, B), u_(A.rows()), g_(B.rows()), w_(B.rows()), multiplier_(B.rows()), lambda_(B.rows()) {
        factor_ = DenseLinearSolver().factorize(A);
        stiffness_ = A.main_diagonal().cwiseSqrt();
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
        double gap_size = 0;
        if (m > 0) {
            g_.noalias() = B_ * u_;
            w_ = c.cwiseProduct(scale_);
            const double largest = (w_ - g_).maxCoeff();  // violation, in energy units
            if (!(largest <= 0) || (point.lambda.array() > 0).any()) {
                allowance_ = gap_tolerance * (g_.cwiseAbs() + w_.cwiseAbs());
                gap_size = (w_.array() == -infinity)
                               .select(0, w_.cwiseAbs().cwiseMax(g_.cwiseAbs()).cwiseQuotient(scale_))
                               .maxCoeff();
                g_ = w_ - g_;
                multiplier_ = point.lambda.cwiseQuotient(scale_);
                const auto dual = dual_.solve(S_, g_, allowance_, multiplier_, w_);
                report.iterations = dual.iterations;
                report.outcome = dual.outcome;
                if (dual.outcome == Outcome::infeasible) {
                    if (!balances(dual_.infeasibility())) {
                        report.outcome = Outcome::inaccurate;
                        return report;
                    }
                    report.infeasibility = dual_.infeasibility().cwiseProduct(scale_);
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
                if (dual_.forgave() && !rows_are_met(c)) {
                    report.outcome = Outcome::inaccurate;
                    return report;
                }
            } else {
                lambda_.setZero();
            }
        }
        // NaN in b or c ends here, as does an A that is singular in all but name.
        certify(report, certificate_, b, c, u_, lambda_, acceptable, gap_size, point);
        return report;
    }

private:
    static constexpr double acceptable = 1e-9;
    /// B'y = 0 in unknowns of unit stiffness, beyond what S y = 0 says where A is nearly singular.
    bool balances(const Vector& y) const {
        const Vector force = B_.transpose() * y, size = B_.cwiseAbs().transpose() * y;
        return force.cwiseQuotient(stiffness_).lpNorm<Eigen::Infinity>() <=
               1e-9 * size.cwiseQuotient(stiffness_).lpNorm<Eigen::Infinity>();
    }
    /// Each row by its own size, and by the rounding of the sum that u is: the certificate's largest one may be a bound that
    /// means none, and where nothing but u = 0 is admissible u is rounding itself.
    bool rows_are_met(const ConstVectorRef& c) const {
        const Vector bound = c.cwiseProduct(scale_), gap = B_ * u_ - bound;
        const Vector own = bound.cwiseAbs() + B_.cwiseAbs() * u_.cwiseAbs();
        const Vector summed = B_.cwiseAbs() * (W_.cwiseAbs() * multiplier_.cwiseAbs());
        return ((gap.array() >= 0) || (gap.array() >= -(acceptable * own + gap_tolerance * summed).array())).all();
    }
    struct Bound {
        Index row, column;
        double weight;
    };
    std::vector<Bound> bounds_;  // the rows of B with one entry
    KktCertificate certificate_;
    std::unique_ptr<const Factor> factor_;
    Vector inverse_;  // of A's diagonal, where it is diagonal
    Vector scale_, stiffness_;
    DenseMatrix B_, W_, S_;
    GoldfarbIdnani dual_;
    Vector u_, g_, w_, allowance_, multiplier_, lambda_;
};

}  // namespace

std::unique_ptr<PreparedContact> DenseContact::prepare(const Matrix& A, const Matrix& B) const {
    check_contact_matrices("DenseContact", A, B);
    if (!A.is_symmetric()) throw InputError("DenseContact: A is " + A.shape() + " and not symmetric");
    if (const Vector* diagonal = A.diagonal_entries(); diagonal && !(diagonal->minCoeff() > 0))
        throw NumericalError("DenseContact: A has a diagonal entry <= 0, expected positive definite");
    if (A.sparse()) {
        if (A.rows() > 2000)
            throw InputError("DenseContact: A is " + A.shape() +
                             ", expected dense, diagonal or at most 2000 unknowns");
        return std::make_unique<PreparedDense>(Matrix(A.to_dense()), B);
    }
    return std::make_unique<PreparedDense>(A, B);
}

}  // namespace tact
