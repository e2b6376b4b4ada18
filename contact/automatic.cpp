#include "tact/contact/automatic.hpp"

#include "tact/contact/colour_sor.hpp"
#include "tact/contact/dense/dense_contact.hpp"
#include "tact/contact/klu_active_set.hpp"
#include "tact/contact/projected_cg.hpp"
#include "tact/contact/rows.hpp"
#include "tact/contact/schur_contact.hpp"
#include "tact/lib/sparse/lanczos.hpp"

namespace tact {
namespace {

constexpr Index small_size = 300;
/// Up to here some 20 sweeps or CG iterations reach rounding: less than a factor's back-substitutions cost.
constexpr double well_conditioned = 20;

class WithFallback final : public PreparedContact {
public:
    WithFallback(const Matrix& A, const Matrix& B, std::unique_ptr<PreparedContact> first)
        : A_(A), B_(B), first_(std::move(first)) {}

    bool reads_guess() const override { return first_->reads_guess(); }

    ContactReport solve(const ConstVectorRef& b, const ConstVectorRef& c, ContactPoint point) override {
        ContactReport report = first_->solve(b, c, point);
        if (report.outcome == Outcome::converged || report.outcome == Outcome::infeasible) return report;
        if (!exact_) exact_ = SchurContact().prepare(A_, B_);
        const ContactReport end = exact_->solve(b, c, point);
        report.outcome = end.outcome;
        report.kkt = end.kkt;
        report.active = end.active;
        report.iterations += end.iterations;
        report.fallback = end.fallback.empty() ? end.strategy : end.fallback;
        return report;
    }

private:
    Matrix A_, B_;
    std::unique_ptr<PreparedContact> first_, exact_;
};

}  // namespace

std::unique_ptr<PreparedContact> AutomaticContact::prepare(const Matrix& A, const Matrix& B) const {
    if (A.rows() != A.cols() || B.cols() != A.rows())
        throw InputError("AutomaticContact: A is " + A.shape() + " and B is " + B.shape() +
                         ", expected a square A and as many columns in B");
    const bool symmetric = A.is_symmetric();
    if (symmetric && (!A.sparse() || A.rows() <= small_size) && B.rows() <= 4 * small_size)
        return DenseContact().prepare(A, B);
    if (!symmetric) return KluActiveSet().prepare(A, B);
    const ConstraintRows rows(B);
    if ((A.main_diagonal().array() > 0).all() && B.rows() > 0 && (rows.bounds() || rows.disjoint()) &&
        scaled_spectrum(A).condition() <= well_conditioned) {
        const ColourSor sor;
        const ProjectedCg cg;
        const ContactSolver& solver = rows.bounds() ? static_cast<const ContactSolver&>(sor) : cg;
        return std::make_unique<WithFallback>(A, B, solver.prepare(A, B));
    }
    return SchurContact().prepare(A, B);
}

}  // namespace tact
