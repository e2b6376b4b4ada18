#include "schur_contact.hpp"

#include <cstdint>
#include <optional>
#include <random>
#include <utility>

#include "../../lib/algebra/empty_rows.hpp"
#include "../../lib/algebra/linear_solver.hpp"
#include "../../lib/sparse/cholmod_solver.hpp"
#include "../dense/acceptance.hpp"
#include "touched_rows.hpp"

namespace tact {
namespace {

class PreparedSchur final : public PreparedContact {
public:
    PreparedSchur(const Matrix& A, const Matrix& B, std::shared_ptr<const LinearSolver> linear, SchurOptions options)
        : linear_(std::move(linear)),
          options_(options),
          factor_(linear_->factorize(A)),
          B_(B),
          accept_(A, B),
          rows_(B),
          free_(A.rows()) {
        check_stiffness(A, *factor_);
        touched_.emplace(*factor_, nullptr, B_, rows_, options_.pool_bytes);
    }

    /// The pool begins anew with the rows that the next guess presses on.
    bool update(const Matrix& A) override {
        if (A.rows() != free_.size() || A.cols() != free_.size() || !A.is_symmetric()) return false;
        auto factor = factor_->refactorized(A);
        if (!factor) factor = linear_->factorize(A);
        check_stiffness(A, *factor);
        accept_ = Acceptance(A, B_);
        load_.resize(0);
        factor_ = std::move(factor);
        touched_.emplace(*factor_, nullptr, B_, rows_, options_.pool_bytes);
        return true;
    }

    ContactReport solve(const ConstVectorRef& b, const ConstVectorRef& c, ContactPoint point) override {
        ContactReport report;
        report.strategy = "Schur complement";
        if (load_.size() != b.size() || load_ != b) {
            free_ = b;
            factor_->solve(free_);
            load_ = b;
            reach_ = accept_.reach(free_);
        }
        report.outcome =
            touched_->solve(free_, c, point.lambda, report, options_.pool_rows - touched_->pool().size());
        if (report.outcome != Outcome::converged) return report;
        accept_.certify(report, b, c, touched_->u(), touched_->lambda(), acceptable, reach_, point);
        return report;
    }

private:
    static constexpr double acceptable = 1e-10;

    /// Two steps of inverse iteration from numbers that are the same everywhere.
    void check_stiffness(const Matrix& A, const Factor& factor) const {
        if (options_.least_stiffness == 0) return;
        const Vector diagonal = A.main_diagonal();
        std::mt19937_64 random(1);
        Vector x(A.rows());
        for (double& entry : x) entry = static_cast<double>(static_cast<std::int64_t>(random())) * 0x1p-63;
        x = diagonal.cwiseSqrt().cwiseProduct(x);
        for (int step = 0; step < 2; ++step) {
            const Vector force = x / x.lpNorm<Eigen::Infinity>();
            x = force;
            factor.solve(x);
            const double stiffness = x.dot(force) / diagonal.dot(x.cwiseAbs2());
            if (stiffness < options_.least_stiffness)
                throw NumericalError("SchurContact: A is " + A.shape() + " and nearly singular");
            x = diagonal.cwiseProduct(x);
        }
    }

    std::shared_ptr<const LinearSolver> linear_;
    SchurOptions options_;
    std::unique_ptr<const Factor> factor_;
    Matrix B_;
    Acceptance accept_;
    ConstraintRows rows_;
    std::optional<TouchedRows> touched_;
    double reach_ = 0;  // of free_, in units of energy
    Vector load_, free_;
};

}  // namespace

SchurContact::SchurContact(SchurOptions options, std::shared_ptr<const LinearSolver> linear)
    : options_(options), linear_(linear ? std::move(linear) : std::make_shared<CholmodSolver>()) {}

std::unique_ptr<PreparedContact> SchurContact::prepare(const Matrix& A, const Matrix& B) const {
    check_contact_matrices("SchurContact", A, B);
    if (has_empty_rows(B)) return prepare_without_empty_rows(*this, A, B);
    if (!A.is_symmetric())
        throw InputError("SchurContact: A is " + A.shape() + " and not symmetric; use KluActiveSet");
    return std::make_unique<PreparedSchur>(A, B, linear_, options_);
}

}  // namespace tact
