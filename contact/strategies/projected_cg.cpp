#include "projected_cg.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "../../lib/algebra/empty_rows.hpp"
#include "../../lib/sparse/aggregation.hpp"
#include "../../lib/sparse/sliced_rows.hpp"
#include "../dense/acceptance.hpp"
#include "../prepare/rows.hpp"

namespace tact {
namespace {

/// A symmetric sparse matrix scaled to unit diagonal.
class ScaledRows {
public:
    ScaledRows(const SparseMatrix& A, const Vector& scale) : rows_(A.rows()) {
        const CompressedRows entries = compressed_columns(A);
        const Index padded = (rows_ + Slices::lanes - 1) / Slices::lanes * Slices::lanes;
        slices_ = Slices(static_cast<int>(padded), entries.longest_row(), [&](int i, const auto& add) {
            if (i >= entries.rows) return;
            for (int k = entries.begin(i); k < entries.end(i); ++k)
                add(entries.column_at(k), entries.value_at(k) * scale[i] * scale[entries.column_at(k)]);
        });
        operand_.setZero(padded + 2 * Slices::padding);
        product_.resize(padded);
    }
    void multiply(const double* x, double* y) {
        std::copy_n(x, rows_, operand_.data() + Slices::padding);
        const Slices::Reader slices = slices_.reader();
        for (int s = 0; s < slices_.slices(); ++s) {
            Slices::Lanes sum;
            slices.multiply_slice(s, operand_.data() + Slices::padding, sum);
            Slices::store(product_.data() + s * Slices::lanes, sum);
        }
        std::copy_n(product_.data(), rows_, y);
    }

private:
    using Slices = SlicedRows<double>;
    Index rows_;
    Slices slices_;
    Vector operand_, product_;
};

SparseMatrix scaled_rows_of(const Matrix& B, const Vector& scale, Vector& row_scale) {
    SparseMatrix S = B.to_sparse() * scale.asDiagonal();
    row_scale = Vector::Zero(S.rows());
    for (Index j = 0; j < S.outerSize(); ++j)
        for (SparseMatrix::InnerIterator it(S, j); it; ++it) row_scale[it.row()] += it.value() * it.value();
    row_scale = row_scale.cwiseSqrt().cwiseInverse();
    return row_scale.asDiagonal() * S;
}

class PreparedCg final : public PreparedContact {
public:
    PreparedCg(const Matrix& A, const Matrix& B)
        : accept_(A, B),
          scale_(A.main_diagonal().cwiseSqrt().cwiseInverse()),
          A_(A.to_sparse(), scale_),
          rows_(Matrix(scaled_rows_of(B, scale_, row_scale_))),
          in_contact_(static_cast<std::size_t>(B.rows()), 0) {
        for (Vector* v : {&x_, &b_, &r_, &p_, &q_, &u_}) v->resize(A.rows());
        c_.resize(B.rows());
        lambda_.resize(B.rows());
    }

    bool reads_guess() const override { return true; }

    ContactReport solve(const ConstVectorRef& b, const ConstVectorRef& c, ContactPoint point) override {
        ContactReport report;
        report.strategy = "projected CG";
        x_ = point.u.cwiseQuotient(scale_);
        b_ = b.cwiseProduct(scale_);
        c_ = c.cwiseProduct(row_scale_);
        lambda_ = point.lambda.cwiseQuotient(row_scale_);
        double floor = attainable();
        active_.clear();
        choose_set(floor);
        std::vector<std::uint64_t> settled;
        double residual = start_residual();
        for (report.iterations = 1;; ++report.iterations) {
            if (report.iterations > iteration_limit) {
                report.outcome = Outcome::iteration_limit;
                return report;
            }
            const double goal = std::max(floor, inexactness * residual);
            residual = conjugate_gradients(goal);
            if (!std::isfinite(residual)) {
                report.outcome = Outcome::inaccurate;
                return report;
            }
            if (const double finer = attainable(); finer < 0.1 * floor) {
                // The guess was far larger than the solution, and so is its rounding.
                floor = finer;
                residual = start_residual();
            }
            estimate_multipliers();
            const bool changed = choose_set(floor);
            if (!changed && residual <= floor) break;
            if (changed && residual <= floor) {
                // An exact step that leads back to a set already solved exactly will do so for ever.
                const auto print = fingerprint();
                if (std::find(settled.begin(), settled.end(), print) != settled.end()) {
                    report.set_repeated = true;
                    report.outcome = Outcome::cycling;
                    return report;
                }
                settled.push_back(print);
            }
            if (changed) residual = start_residual();
        }
        for (Index i = 0; i < lambda_.size(); ++i)
            lambda_[i] = in_contact_[static_cast<std::size_t>(i)] ? std::max(lambda_[i], 0.0) * row_scale_[i] : 0.0;
        u_ = x_.cwiseProduct(scale_);
        accept_.certify(report, b, c, u_, lambda_, acceptable, accept_.reach(point.u), point);
        return report;
    }

private:
    static constexpr double accuracy = 2e-13;
    static constexpr double acceptable = 1e-10;
    static constexpr double inexactness = 0.03;
    static constexpr int iteration_limit = 100;

    /// The certificate divides by |A||x| + |b| + |B'||lambda|, in these units about the larger of x and b.
    double attainable() const {
        return accuracy * std::max({x_.cwiseAbs().maxCoeff(), b_.cwiseAbs().maxCoeff(), underflow});
    }

    /// C := {lambda_i + c_i - B_i x > 0} and x is moved onto B_C x = c_C. Says whether C changed.
    bool choose_set(double floor) {
        bool changed = false;
        active_.clear();
        for (Index i = 0; i < c_.size(); ++i) {
            auto& in = in_contact_[static_cast<std::size_t>(i)];
            const double gap = rows_.gather(i, x_.data()) - c_[i];
            const bool now = in ? lambda_[i] - gap > 0 : gap < -floor;
            changed |= now != static_cast<bool>(in);
            in = now;
            if (!now) continue;
            active_.push_back(i);
            rows_.scatter(i, -gap, x_.data());
        }
        return changed;
    }

    void project(Vector& r) const {
        for (const Index i : active_) rows_.scatter(i, -rows_.gather(i, r.data()), r.data());
    }

    double start_residual() {
        A_.multiply(x_.data(), q_.data());
        r_ = b_ - q_;
        project(r_);
        return r_.cwiseAbs().maxCoeff();
    }

    /// On the null space of B_C, until the residual's max norm is below `goal`. r_ holds the projected residual.
    double conjugate_gradients(double goal) {
        p_ = r_;
        double rr = r_.squaredNorm();
        double largest = r_.cwiseAbs().maxCoeff();
        for (int k = 0; largest > goal && k < 10000; ++k) {
            A_.multiply(p_.data(), q_.data());
            project(q_);
            const double alpha = rr / p_.dot(q_);
            x_ += alpha * p_;
            r_ -= alpha * q_;
            const double next = r_.squaredNorm();
            largest = r_.cwiseAbs().maxCoeff();
            p_ = r_ + (next / rr) * p_;
            rr = next;
            if (!std::isfinite(alpha)) return alpha;
        }
        // The recursion drifts from the true residual by rounding; the next start takes the true one.
        return largest;
    }

    /// On C: lambda_C = B_C (A x - b); zero elsewhere.
    void estimate_multipliers() {
        lambda_.setZero();
        if (active_.empty()) return;
        A_.multiply(x_.data(), q_.data());
        q_ -= b_;
        for (const Index i : active_) lambda_[i] = rows_.gather(i, q_.data());
    }

    std::uint64_t fingerprint() const {
        std::uint64_t hash = 1469598103934665603ULL;
        for (const Index i : active_) hash = (hash ^ static_cast<std::uint64_t>(i)) * 1099511628211ULL;
        return hash;
    }

    Acceptance accept_;
    Vector scale_, row_scale_;
    ScaledRows A_;
    ConstraintRows rows_;
    std::vector<char> in_contact_;
    std::vector<Index> active_;
    Vector x_, b_, c_, lambda_, r_, p_, q_, u_;
};

}  // namespace

std::unique_ptr<PreparedContact> ProjectedCg::prepare(const Matrix& A, const Matrix& B) const {
    check_contact_matrices("ProjectedCg", A, B);
    if (has_empty_rows(B)) return prepare_without_empty_rows(*this, A, B);
    if (!A.is_symmetric()) throw InputError("ProjectedCg: A is " + A.shape() + " and not symmetric");
    if (!(A.main_diagonal().array() > 0).all())
        throw InputError("ProjectedCg: A has a diagonal entry <= 0, expected positive definite");
    if (B.rows() > 0 && !ConstraintRows(B).disjoint())
        throw InputError("ProjectedCg: rows of B overlap or are empty, expected at most one row an unknown");
    return std::make_unique<PreparedCg>(A, B);
}

}  // namespace tact
