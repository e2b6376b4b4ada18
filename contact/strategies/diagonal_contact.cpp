#include "diagonal_contact.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "../prepare/rows.hpp"

#include "../../lib/algebra/empty_rows.hpp"

namespace tact {
namespace {

class PreparedDiagonal final : public PreparedContact {
public:
    PreparedDiagonal(const Matrix& A, const Matrix& B, ConstraintRows rows)
        : B_(B),
          certificate_(A, B),
          rows_(std::move(rows)),
          u_(A.rows()),
          lambda_(rows_.rows()),
          row_of_(static_cast<std::size_t>(A.rows()), -1) {
        take(*A.diagonal_entries());
    }

    bool update(const Matrix& A) override {
        const Vector* diagonal = A.diagonal_entries();
        if (!diagonal || diagonal->size() != u_.size() || !(diagonal->array() >= 0).all()) return false;
        certificate_ = KktCertificate(A, B_);
        take(*diagonal);
        return true;
    }

    bool reads_guess() const override { return !loose_.empty(); }

    ContactReport solve(const ConstVectorRef& b, const ConstVectorRef& c, ContactPoint point) override {
        ContactReport report;
        report.strategy = "row by row";
        report.iterations = 1;
        u_ = inverse_.cwiseProduct(b);
        lambda_.setZero();
        const double nothing = loose_.empty() ? 0 : rounding * b.lpNorm<Eigen::Infinity>();
        for (const Index j : loose_) {
            u_[j] = std::isfinite(point.u[j]) ? point.u[j] : 0;
            const Index row = row_of_[static_cast<std::size_t>(j)];
            if ((row < 0 || c[row] == -infinity) && std::abs(b[j]) > nothing) {
                runs_off(report, j, b[j] > 0 ? 1 : -1);
                return report;
            }
        }
        double gap_size = 0;
        for (Index i = 0; i < rows_.rows(); ++i) {
            if (c[i] == -infinity) continue;
            if (compliance_[i] == infinity) {
                if (!meet_loosely(i, b, c[i], nothing, gap_size, report)) return report;
                continue;
            }
            const double gap = rows_.gather(i, u_.data());
            gap_size = std::max({gap_size, std::abs(c[i]), std::abs(gap)});
            if (!(gap < c[i])) continue;
            lambda_[i] = (c[i] - gap) / compliance_[i];
            const auto columns = rows_.columns(i);
            const auto weights = rows_.weights(i);
            if (columns.size() == 1) {
                u_[columns[0]] = c[i] / weights[0];  // exactly: a gap of zero then is zero, not rounding
                continue;
            }
            for (std::size_t k = 0; k < columns.size(); ++k)
                u_[columns[k]] += lambda_[i] * weights[k] * inverse_[columns[k]];
        }
        certify(report, certificate_, b, c, u_, lambda_, acceptable, gap_size, point);
        return report;
    }

private:
    void take(const Vector& diagonal) {
        // 0 for an unknown without stiffness: neither b nor a multiplier moves it.
        inverse_ = diagonal.unaryExpr([](double a) { return a > 0 ? 1 / a : 0.0; });
        compliance_.resize(rows_.rows());
        for (Index i = 0; i < rows_.rows(); ++i) {
            double sum = 0;
            const auto columns = rows_.columns(i);
            const auto weights = rows_.weights(i);
            bool loose = false;
            for (std::size_t k = 0; k < columns.size(); ++k) {
                sum += weights[k] * weights[k] * inverse_[columns[k]];
                row_of_[static_cast<std::size_t>(columns[k])] = i;
                loose |= inverse_[columns[k]] == 0;
            }
            compliance_[i] = loose ? infinity : sum;
        }
        loose_.clear();
        for (Index j = 0; j < inverse_.size(); ++j)
            if (inverse_[j] == 0) loose_.push_back(j);
    }

    static constexpr double acceptable = 1e-10;
    /// Of the largest load: a load that is less is none.
    static constexpr double rounding = 1e-15;

    /// A row with unknowns j that have no stiffness: 0 = b_j + w_j lambda for each of them, so the loads give the multiplier
    /// and these unknowns alone move, as little as may be, to meet the row. false where no multiplier >= 0 balances them.
    bool meet_loosely(Index i, const ConstVectorRef& b, double c, double nothing, double& gap_size,
                      ContactReport& report) {
        const auto columns = rows_.columns(i);
        const auto weights = rows_.weights(i);
        std::size_t least = columns.size(), most = least;  // of b_j / w_j, which is -lambda
        double size = 0;                                   // of the weights of these unknowns, squared
        const auto pull = [&](std::size_t k) {
            return std::abs(b[columns[k]]) > nothing ? b[columns[k]] / weights[k] : 0;
        };
        for (std::size_t k = 0; k < columns.size(); ++k) {
            if (inverse_[columns[k]] != 0) continue;
            size += weights[k] * weights[k];
            if (least == columns.size() || pull(k) < pull(least)) least = k;
            if (most == columns.size() || pull(k) > pull(most)) most = k;
        }
        const double low = pull(least), high = pull(most);
        if (high > 0) {
            runs_off(report, columns[most], weights[most] > 0 ? 1 : -1);
            return false;
        }
        if (high - low > 4 * rounding * -low) {
            // Against each other, so that the row does not move.
            report.outcome = Outcome::unbounded;
            report.ray = Vector::Zero(u_.size());
            report.ray[columns[most]] = 1 / weights[most];
            report.ray[columns[least]] = -1 / weights[least];
            report.ray /= report.ray.lpNorm<Eigen::Infinity>();
            return false;
        }
        lambda_[i] = -0.5 * (low + high);
        for (std::size_t k = 0; k < columns.size(); ++k)
            u_[columns[k]] += lambda_[i] * weights[k] * inverse_[columns[k]];
        const double gap = rows_.gather(i, u_.data());
        gap_size = std::max({gap_size, std::abs(c), std::abs(gap)});
        if (lambda_[i] == 0 && !(gap < c)) return true;
        for (std::size_t k = 0; k < columns.size(); ++k)
            if (inverse_[columns[k]] == 0) u_[columns[k]] += (c - gap) * weights[k] / size;
        if (columns.size() == 1) u_[columns[0]] = c / weights[0];
        return true;
    }

    void runs_off(ContactReport& report, Index unknown, double direction) const {
        report.outcome = Outcome::unbounded;
        report.ray = Vector::Zero(u_.size());
        report.ray[unknown] = direction;
    }

    Matrix B_;
    KktCertificate certificate_;
    ConstraintRows rows_;
    Vector inverse_, compliance_, u_, lambda_;
    std::vector<Index> row_of_;  // of each unknown: the row it is in, or -1
    std::vector<Index> loose_;   // unknowns without stiffness
};

}  // namespace

std::unique_ptr<PreparedContact> DiagonalContact::prepare(const Matrix& A, const Matrix& B) const {
    if (A.rows() != A.cols() || B.cols() != A.rows())
        throw InputError("DiagonalContact: A is " + A.shape() + " and B is " + B.shape() +
                         ", expected a square A and as many columns in B");
    if (has_empty_rows(B)) return prepare_without_empty_rows(*this, A, B);
    const Vector* diagonal = A.diagonal_entries();
    if (!diagonal || !(diagonal->array() >= 0).all())
        throw InputError("DiagonalContact: A is " + A.shape() + ", expected a diagonal matrix with entries >= 0");
    ConstraintRows rows(B);
    if (!rows.disjoint())
        throw InputError("DiagonalContact: B is " + B.shape() +
                         " with rows that overlap or are empty, expected neither");
    return std::make_unique<PreparedDiagonal>(A, B, std::move(rows));
}

}  // namespace tact
