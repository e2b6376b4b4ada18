#include "refined_contact.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "../../lib/algebra/empty_rows.hpp"
#include "../../lib/algebra/extended_sums.hpp"

namespace tact {
namespace {

class PreparedRefined final : public PreparedContact {
public:
    PreparedRefined(const Matrix& A, const Matrix& B, const ContactSolver& inner)
        : A_(A), B_(B), inner_(inner.prepare(A, B)), certificate_(A, B) {}

    ContactReport solve(const ConstVectorRef& b, const ConstVectorRef& c, ContactPoint point) override {
        ContactReport report = inner_->solve(b, c, point);
        if (report.outcome != Outcome::converged) return report;
        for (const double tau : {1e-6, 1e-12}) {
            keep_ = (point.lambda.array() - tau * point.lambda.lpNorm<Eigen::Infinity>()).cwiseMax(0.0);
            lambda_ = point.lambda - keep_;
            residuals(b, c, point.u);
            correction_.setZero(A_.rows());
            const ContactReport step = inner_->solve(r_, gap_, {correction_, lambda_});
            report.iterations += step.iterations;
            if (step.outcome != Outcome::converged) break;
            correction_ += point.u;
            lambda_ += keep_;
            const KktResiduals kkt = certificate_(b, c, correction_, lambda_);
            // Residuals this small are roundings of the products: they no longer tell the better point.
            if (kkt.largest() > std::max(report.kkt.largest(), rounding)) break;
            if (kkt.largest() > sharp && closes_worse(c, point.u, correction_)) break;
            point.u = correction_;
            point.lambda = lambda_;
            report.kkt = kkt;
        }
        report.active = (point.lambda.array() > 0).count();
        return report;
    }
    bool reads_guess() const override { return inner_->reads_guess(); }
    bool update(const Matrix& A) override {
        if (!inner_->update(A)) return false;
        A_ = A;
        certificate_ = KktCertificate(A, B_);
        return true;
    }

private:
    static constexpr double rounding = 1e-15;
    static constexpr double sharp = 1e-12;

    /// Whether a row is violated further, in its own size, by `after` than by `before`: the largest row, which the residuals
    /// are scaled by, would hide it.
    bool closes_worse(const ConstVectorRef& c, const ConstVectorRef& before, const ConstVectorRef& after) const {
        const DenseMatrix points = (DenseMatrix(after.size(), 2) << before, after).finished();
        const SparseMatrix B = B_.to_sparse();
        const DenseMatrix gaps = B * points;
        const Vector sizes = B.cwiseAbs() * after.cwiseAbs();
        for (Index i = 0; i < c.size(); ++i)
            if (c[i] > -infinity &&
                c[i] - gaps(i, 1) > std::max(c[i] - gaps(i, 0), sharp * (sizes[i] + std::abs(c[i]))))
                return true;
        return false;
    }

    void residuals(const ConstVectorRef& b, const ConstVectorRef& c, const ConstVectorRef& u) {
        sums_.start(b);
        sums_.add(A_, false, -1, u);
        sums_.add(B_, true, 1, keep_);
        sums_.end(r_);
        sums_.start(c);
        sums_.add(B_, false, -1, u);
        sums_.end(gap_);
        // A row this far open takes no part, and its gap would hide the others' roundings from the inner solver's tolerance.
        // Were it wrong, the certificate would drop the correction.
        for (Index i = 0; i < gap_.size(); ++i)
            if (keep_[i] == 0 && lambda_[i] == 0 && gap_[i] < -1e-6 * (std::abs(c[i]) + std::abs(c[i] - gap_[i])))
                gap_[i] = -infinity;
    }

    Matrix A_, B_;
    std::unique_ptr<PreparedContact> inner_;
    KktCertificate certificate_;
    ExtendedSums sums_;
    Vector keep_, r_, gap_, correction_, lambda_;
};

}  // namespace

RefinedContact::RefinedContact(std::shared_ptr<const ContactSolver> inner) : inner_(std::move(inner)) {}

std::unique_ptr<PreparedContact> RefinedContact::prepare(const Matrix& A, const Matrix& B) const {
    check_contact_matrices("RefinedContact", A, B);
    if (has_empty_rows(B)) return prepare_without_empty_rows(*this, A, B);
    return std::make_unique<PreparedRefined>(A, B, *inner_);
}

}  // namespace tact
