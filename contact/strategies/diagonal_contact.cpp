#include "diagonal_contact.hpp"

#include <algorithm>
#include <cmath>

#include "../prepare/rows.hpp"

namespace tact {
namespace {

class PreparedDiagonal final : public PreparedContact {
public:
    PreparedDiagonal(const Matrix& A, const Matrix& B, ConstraintRows rows)
        : B_(B), certificate_(A, B), rows_(std::move(rows)), u_(A.rows()), lambda_(rows_.rows()) {
        take(*A.diagonal_entries());
    }

    bool update(const Matrix& A) override {
        const Vector* diagonal = A.diagonal_entries();
        if (!diagonal || diagonal->size() != u_.size() || !(diagonal->array() > 0).all()) return false;
        certificate_ = KktCertificate(A, B_);
        take(*diagonal);
        return true;
    }

    ContactReport solve(const ConstVectorRef& b, const ConstVectorRef& c, ContactPoint point) override {
        ContactReport report;
        report.strategy = "row by row";
        report.iterations = 1;
        u_ = inverse_.cwiseProduct(b);
        lambda_.setZero();
        double gap_size = 0;
        for (Index i = 0; i < rows_.rows(); ++i) {
            if (c[i] == -infinity) continue;
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
        inverse_ = diagonal.cwiseInverse();
        compliance_.resize(rows_.rows());
        for (Index i = 0; i < rows_.rows(); ++i) {
            double sum = 0;
            const auto columns = rows_.columns(i);
            const auto weights = rows_.weights(i);
            for (std::size_t k = 0; k < columns.size(); ++k) sum += weights[k] * weights[k] * inverse_[columns[k]];
            compliance_[i] = sum;
        }
    }

    static constexpr double acceptable = 1e-10;
    Matrix B_;
    KktCertificate certificate_;
    ConstraintRows rows_;
    Vector inverse_, compliance_, u_, lambda_;
};

}  // namespace

std::unique_ptr<PreparedContact> DiagonalContact::prepare(const Matrix& A, const Matrix& B) const {
    if (A.rows() != A.cols() || B.cols() != A.rows())
        throw InputError("DiagonalContact: A is " + A.shape() + " and B is " + B.shape() +
                         ", expected a square A and as many columns in B");
    const Vector* diagonal = A.diagonal_entries();
    if (!diagonal || !(diagonal->array() > 0).all())
        throw InputError("DiagonalContact: A is " + A.shape() + ", expected a diagonal matrix with positive entries");
    ConstraintRows rows(B);
    if (!rows.disjoint())
        throw InputError("DiagonalContact: B is " + B.shape() +
                         " with rows that overlap or are empty, expected neither");
    return std::make_unique<PreparedDiagonal>(A, B, std::move(rows));
}

}  // namespace tact
