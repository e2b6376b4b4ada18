#include "schur_contact.hpp"

#include <utility>

#include "../../lib/algebra/linear_solver.hpp"
#include "../../lib/sparse/cholmod_solver.hpp"
#include "../dense/acceptance.hpp"
#include "touched_rows.hpp"

namespace tact {
namespace {

class PreparedSchur final : public PreparedContact {
public:
    PreparedSchur(const Matrix& A, const Matrix& B, const LinearSolver& linear, SchurOptions options)
        : factor_(linear.factorize(A)),
          accept_(A, B),
          rows_(B),
          touched_(*factor_, nullptr, B, rows_, options.pool_bytes),
          pool_rows_(options.pool_rows),
          free_(A.rows()) {}

    ContactReport solve(const ConstVectorRef& b, const ConstVectorRef& c, ContactPoint point) override {
        ContactReport report;
        report.strategy = "Schur complement";
        if (load_.size() != b.size() || load_ != b) {
            free_ = b;
            factor_->solve(free_);
            load_ = b;
            reach_ = accept_.reach(free_);
        }
        report.outcome = touched_.solve(free_, c, point.lambda, report, pool_rows_ - touched_.pool().size());
        if (report.outcome != Outcome::converged) return report;
        accept_.certify(report, b, c, touched_.u(), touched_.lambda(), acceptable, reach_, point);
        return report;
    }

private:
    static constexpr double acceptable = 1e-10;

    std::unique_ptr<const Factor> factor_;
    Acceptance accept_;
    ConstraintRows rows_;
    TouchedRows touched_;
    Index pool_rows_;
    double reach_ = 0;  // of free_, in units of energy
    Vector load_, free_;
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
