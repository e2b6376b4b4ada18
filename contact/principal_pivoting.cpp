#include "tact/contact/principal_pivoting.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <vector>

#include "tact/contact/rows.hpp"
#include "tact/lib/sparse/klu_solver.hpp"

namespace tact {
namespace {

class PreparedPivoting final : public PreparedContact {
public:
    PreparedPivoting(const Matrix& A, const Matrix& B)
        : certificate_(A, B), factor_(KluSolver().factorize(A)), rows_(B), W_(B.to_dense().transpose()) {
        factor_->solve(W_);
        S_ = B.times(W_);
        lambda_.resize(B.rows());
        g_.resize(B.rows());
        allowance_.resize(B.rows());
    }

    ContactReport solve(const ConstVectorRef& b, const ConstVectorRef& c, ContactPoint point) override {
        ContactReport report;
        report.strategy = "principal pivoting";
        free_ = b;
        factor_->solve(free_);
        const Index m = g_.size();
        double size = 0;
        active_.assign(static_cast<std::size_t>(m), 0);
        for (Index i = 0; i < m; ++i) {
            const double own = std::abs(c[i]) + rows_.gather_absolute(i, free_.data());
            g_[i] = c[i] - rows_.gather(i, free_.data());
            allowance_[i] = 2e-14 * own;
            if (c[i] != -infinity) size = std::max(size, own);
            active_[static_cast<std::size_t>(i)] = point.lambda[i] > 0 && c[i] != -infinity;
        }
        Index fewest = m + 1;
        int patience = 3;
        const int limit = 1000 + 20 * static_cast<int>(m);
        for (report.iterations = 1;; ++report.iterations) {
            if (report.iterations > limit || !balance()) {
                report.outcome = report.iterations > limit ? Outcome::iteration_limit : Outcome::cycling;
                return report;
            }
            find_wrong();
            if (wrong_.empty()) break;
            const Index count = static_cast<Index>(wrong_.size());
            if (count < fewest) {
                fewest = count;
                patience = 3;
            } else {
                --patience;
            }
            if (patience <= 0) wrong_.erase(wrong_.begin() + 1, wrong_.end());  // Murty: the least index alone
            for (const Index i : wrong_) active_[static_cast<std::size_t>(i)] ^= 1;
        }
        u_ = free_ + W_ * lambda_;
        certify(report, certificate_, b, c, u_, lambda_, 1e-10, size, point);
        return report;
    }

private:
    /// S(C, C) lambda_C = g_C; false if the block is singular.
    bool balance() {
        rows_in_contact_.clear();
        for (Index i = 0; i < g_.size(); ++i)
            if (active_[static_cast<std::size_t>(i)]) rows_in_contact_.push_back(i);
        lambda_.setZero();
        const Index k = static_cast<Index>(rows_in_contact_.size());
        if (k == 0) return true;
        const auto row = [&](Index i) { return rows_in_contact_[static_cast<std::size_t>(i)]; };
        DenseMatrix block(k, k);
        Vector right(k);
        for (Index j = 0; j < k; ++j) {
            right[j] = g_[row(j)];
            for (Index i = 0; i < k; ++i) block(i, j) = S_(row(i), row(j));
        }
        const Eigen::PartialPivLU<DenseMatrix> lu(block);
        if (!(lu.rcond() > 1e-15)) return false;
        right = lu.solve(right).eval();
        for (Index j = 0; j < k; ++j) lambda_[row(j)] = right[j];
        return lambda_.allFinite();
    }

    /// Rows with a negative multiplier, or violated without one, in ascending order.
    void find_wrong() {
        wrong_.clear();
        gap_ = S_ * lambda_;
        for (Index i = 0; i < g_.size(); ++i) {
            const double gap = gap_[i] - g_[i];
            if (active_[static_cast<std::size_t>(i)] ? lambda_[i] < 0 : gap < -allowance_[i]) wrong_.push_back(i);
        }
    }

    KktCertificate certificate_;
    std::unique_ptr<const Factor> factor_;
    ConstraintRows rows_;
    DenseMatrix W_, S_;
    std::vector<char> active_;
    std::vector<Index> wrong_, rows_in_contact_;
    Vector free_, u_, g_, gap_, allowance_, lambda_;
};

}  // namespace

std::unique_ptr<PreparedContact> PrincipalPivoting::prepare(const Matrix& A, const Matrix& B) const {
    if (A.rows() != A.cols() || B.cols() != A.rows() || B.rows() > 6000)
        throw InputError("PrincipalPivoting: A is " + A.shape() + " and B is " + B.shape() +
                         ", expected a square A, as many columns in B and at most 6000 rows");
    return std::make_unique<PreparedPivoting>(A, B);
}

}  // namespace tact
