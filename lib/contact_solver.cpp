#include "contact_solver.hpp"

#include "algebra/linear_solver.hpp"

namespace tact {

void certify(ContactReport& report, const KktCertificate& certificate, const ConstVectorRef& b, const RowBounds& rows,
             const ConstVectorRef& u, const ConstVectorRef& lambda, double tolerance, double gap_size,
             ContactPoint point) {
    report.kkt = certificate(b, rows, u, lambda);
    report.active = (lambda.array() != 0).count();
    if (!report.kkt.within(tolerance, gap_size)) {
        report.outcome = Outcome::inaccurate;
        return;
    }
    point.u = u;
    point.lambda = lambda;
}

void certify(ContactReport& report, const KktCertificate& certificate, const ConstVectorRef& b,
             const ConstVectorRef& c, const ConstVectorRef& u, const ConstVectorRef& lambda, double tolerance,
             double gap_size, ContactPoint point) {
    certify(report, certificate, b, RowBounds(c), u, lambda, tolerance, gap_size, point);
}

ContactReport PreparedContact::solve_rows(const ConstVectorRef& b, const RowBounds& rows, ContactPoint point) {
    if (rows.contact_only()) return solve(b, rows.lower, point);
    throw InputError(
        "this contact solver was prepared for rows B u >= c, and a row has an upper bound or a bounded force; "
        "expected one made by prepare_rows");
}

std::unique_ptr<PreparedContact> ContactSolver::prepare_rows(const Matrix&, const Matrix&) const {
    throw InputError(
        "this contact strategy takes rows B u >= c only, and the problem has rows with an upper bound or a "
        "bounded force; use AutomaticContact, or IntervalContact around the strategy");
}

void check_contact_matrices(std::string_view solver, const Matrix& A, const Matrix& B) {
    if (A.rows() != A.cols() || B.cols() != A.rows() || A.rows() == 0)
        throw InputError(std::string(solver) + ": A is " + A.shape() + " and B is " + B.shape() +
                         ", expected a square A that is not empty and as many columns in B");
    for (const auto& [name, matrix] : {std::pair("A", &A), std::pair("B", &B)})
        if (!matrix->all_finite())
            throw InputError(std::string(solver) + ": " + name +
                             " has a NaN or infinite entry, expected finite entries");
}

bool PreparedContact::update(const Matrix&) { return false; }

namespace {

class PreparedLinear final : public PreparedContact {
public:
    PreparedLinear(const Matrix& A, const Matrix& B, std::shared_ptr<const LinearSolver> linear)
        : linear_(std::move(linear)),
          factor_(linear_->factorize(A)),
          B_(B),
          certificate_(A, B),
          solution_(A.rows()),
          none_(0) {}

    bool update(const Matrix& A) override {
        if (A.rows() != solution_.size() || A.cols() != solution_.size()) return false;
        auto factor = factor_->refactorized(A);
        factor_ = factor ? std::move(factor) : linear_->factorize(A);
        certificate_ = KktCertificate(A, B_);
        return true;
    }

    ContactReport solve(const ConstVectorRef& b, const ConstVectorRef&, ContactPoint point) override {
        solution_ = b;
        factor_->solve(solution_);
        ContactReport report;
        report.strategy = "linear";
        certify(report, certificate_, b, none_, solution_, none_, 1e-9, 0, point);
        return report;
    }

private:
    std::shared_ptr<const LinearSolver> linear_;
    std::unique_ptr<const Factor> factor_;
    Matrix B_;
    KktCertificate certificate_;
    Vector solution_;
    Vector none_;
};

}  // namespace

WithoutContact::WithoutContact(std::shared_ptr<const LinearSolver> linear) : linear_(std::move(linear)) {}

std::unique_ptr<PreparedContact> WithoutContact::prepare(const Matrix& A, const Matrix& B) const {
    if (B.rows() > 0)
        throw InputError("WithoutContact: B is " + B.shape() + ", expected no rows; use a contact solver");
    return std::make_unique<PreparedLinear>(A, B, linear_);
}

}  // namespace tact
