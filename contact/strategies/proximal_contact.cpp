#include "proximal_contact.hpp"

#include <cmath>

#include "../../lib/algebra/empty_rows.hpp"

namespace tact {
namespace {

class PreparedProximal final : public PreparedContact {
public:
    PreparedProximal(const Matrix& A, const Matrix& B, Vector delta, const ContactSolver& inner)
        : A_(A),
          B_(B),
          delta_(std::move(delta)),
          inner_(inner.prepare(combine(1, A, 1, Matrix::diagonal(delta_)), B)),
          certificate_(A, B),
          unit_(delta_.cwiseSqrt().cwiseInverse()),
          absolute_A_(A.to_sparse().cwiseAbs()) {
        const SparseMatrix rows = B.to_sparse();
        absolute_Bt_ = rows.cwiseAbs().transpose();
        if (rows.nonZeros() > 0) largest_weight_ = rows.coeffs().abs().maxCoeff();
    }

    ContactReport solve(const ConstVectorRef& b, const ConstVectorRef& c, ContactPoint point) override {
        u_ = point.u;
        lambda_ = point.lambda;
        ContactReport report;
        int iterations = 0;
        double previous = infinity;
        for (int k = 0; k < iteration_limit; ++k) {
            last_ = u_;
            shifted_ = b + delta_.cwiseProduct(last_);
            report = inner_->solve(shifted_, c, {u_, lambda_});
            report.fallback = report.strategy;
            report.strategy = "proximal point";
            iterations += report.iterations;
            report.iterations = iterations;
            if (report.outcome != Outcome::converged) return report;
            report.kkt = certificate_(b, c, u_, lambda_);
            const double residual = scaled_stationarity(b);
            if (residual <= goal) break;
            const double move = (u_ - last_).norm();
            if (k > 2 && is_ray(b, c, report)) return report;
            // A plateau above the goal is rounding: take what the certificate accepts.
            if (k > 4 && move >= 0.9 * previous && residual <= acceptable && report.kkt.largest() <= acceptable)
                break;
            previous = move;
        }
        if (!(scaled_stationarity(b) <= acceptable && report.kkt.largest() <= acceptable && rows_are_met(c))) {
            report.outcome = Outcome::iteration_limit;
            return report;
        }
        point.u = u_;
        point.lambda = lambda_;
        return report;
    }

private:
    static constexpr double goal = 1e-14;
    static constexpr double acceptable = 1e-10;
    static constexpr int iteration_limit = 200;

    /// |Au - b - B'lambda| = delta |u_last - u| over its terms, in unknowns of unit stiffness: a stiff unknown hides no
    /// soft one.
    double scaled_stationarity(const ConstVectorRef& b) const {
        const Vector size = absolute_A_ * u_.cwiseAbs() + b.cwiseAbs() + absolute_Bt_ * lambda_;
        const double scale = size.cwiseProduct(unit_).lpNorm<Eigen::Infinity>();
        if (scale == 0) return 0;
        const double residual = delta_.cwiseProduct(u_ - last_).cwiseProduct(unit_).lpNorm<Eigen::Infinity>();
        return residual / scale;
    }

    /// Each row by its own size, however rows and unknowns are scaled.
    bool rows_are_met(const ConstVectorRef& c) const {
        const Vector gap = B_ * u_ - c;
        const Vector own = absolute_Bt_.transpose() * u_.cwiseAbs() + c.cwiseAbs();
        return ((gap.array() >= 0) || (gap.array() >= -1e-9 * own.array())).all();
    }

    /// Whether the last step goes where A costs nothing, no row stops it and b pulls: then it can go on for ever.
    bool is_ray(const ConstVectorRef& b, const ConstVectorRef& c, ContactReport& report) {
        Vector d = u_ - last_;
        const double length = d.lpNorm<Eigen::Infinity>();
        if (!(length > 0)) return false;
        d /= length;
        const Vector stiffness = absolute_A_ * d.cwiseAbs();
        const Vector force = A_ * d;
        const Vector rate = B_ * d;
        if ((force.array().abs() > 1e-9 * stiffness.array()).any()) return false;
        for (Index i = 0; i < rate.size(); ++i)
            if (c[i] != -infinity && rate[i] < -1e-9 * largest_weight_) return false;
        if (!(b.dot(d) > 1e-9 * b.lpNorm<1>())) return false;
        report.outcome = Outcome::unbounded;
        report.ray = d;
        return true;
    }

    Matrix A_, B_;
    Vector delta_;
    std::unique_ptr<PreparedContact> inner_;
    KktCertificate certificate_;
    Vector unit_;  // 1/sqrt(delta)
    SparseMatrix absolute_A_, absolute_Bt_;
    double largest_weight_ = 0;
    Vector u_, lambda_, last_, shifted_;
};

}  // namespace

ProximalContact::ProximalContact(std::shared_ptr<const ContactSolver> inner) : inner_(std::move(inner)) {}

std::unique_ptr<PreparedContact> ProximalContact::prepare(const Matrix& A, const Matrix& B) const {
    check_contact_matrices("ProximalContact", A, B);
    if (has_empty_rows(B)) return prepare_without_empty_rows(*this, A, B);
    if (!A.is_symmetric()) throw InputError("ProximalContact: A is " + A.shape() + " and not symmetric");
    const Vector diagonal = A.main_diagonal();
    const double largest = diagonal.maxCoeff();
    if (!(diagonal.minCoeff() >= 0))
        throw InputError("ProximalContact: A has a negative diagonal entry, expected positive semidefinite");
    // Far below the stiffness of a loaded direction, far above the rounding of the factor.
    const Vector delta = diagonal.unaryExpr([largest](double a) {
        return a > 0 ? 1e-7 * a : largest > 0 ? 1e-7 * largest : 1.0;
    });
    return std::make_unique<PreparedProximal>(A, B, delta, *inner_);
}

}  // namespace tact
