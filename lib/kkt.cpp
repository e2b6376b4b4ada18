#include "tact/lib/kkt.hpp"

#include <cmath>
#include <vector>

namespace tact {
namespace {

/// Both arguments are max norms; 0/0 = 0.
double ratio(double numerator, double denominator) {
    if (numerator == 0) return 0;
    return numerator / denominator;
}

/// Rows of a matrix for two products in one pass: y = A x and z = |A||x|.
class Rows {
public:
    explicit Rows(const Matrix& A) : source_(A) {
        const SparseMatrix* S = A.sparse();
        if (!S) return;
        start_.assign(static_cast<std::size_t>(A.rows()) + 1, 0);
        for (Index k = 0; k < S->nonZeros(); ++k) ++start_[static_cast<std::size_t>(S->innerIndexPtr()[k]) + 1];
        for (std::size_t i = 1; i < start_.size(); ++i) start_[i] += start_[i - 1];
        column_.resize(static_cast<std::size_t>(S->nonZeros()));
        value_.resize(column_.size());
        std::vector<int> next(start_.begin(), start_.end() - 1);
        for (Index j = 0; j < S->outerSize(); ++j)
            for (auto k = S->outerIndexPtr()[j]; k < S->outerIndexPtr()[j + 1]; ++k) {
                const auto slot = static_cast<std::size_t>(next[static_cast<std::size_t>(S->innerIndexPtr()[k])]++);
                column_[slot] = static_cast<int>(j);
                value_[slot] = S->valuePtr()[k];
            }
    }

    void multiply(const ConstVectorRef& x, VectorRef y, VectorRef z) const {
        if (const DenseMatrix* A = source_.dense()) {
            y.setZero();
            z.setZero();
            for (Index j = 0; j < A->cols(); ++j) {
                y += x[j] * A->col(j);
                z += std::abs(x[j]) * A->col(j).cwiseAbs();
            }
        } else if (const Vector* d = source_.diagonal_entries()) {
            y = d->cwiseProduct(x);
            z = y.cwiseAbs();
        } else {
            for (Index i = 0; i < source_.rows(); ++i) {
                double sum = 0, absolute = 0;
                const auto end = start_[static_cast<std::size_t>(i) + 1];
                for (auto k = start_[static_cast<std::size_t>(i)]; k < end; ++k) {
                    const double term = value_[static_cast<std::size_t>(k)] * x[column_[static_cast<std::size_t>(k)]];
                    sum += term;
                    absolute += std::abs(term);
                }
                y[i] = sum;
                z[i] = absolute;
            }
        }
    }

    /// y -= A' x and z += |A'||x|, skipping the zeros of x: multipliers are mostly zero.
    void subtract_transposed(const ConstVectorRef& x, VectorRef y, VectorRef z) const {
        for (Index i = 0; i < source_.rows(); ++i) {
            if (x[i] == 0) continue;
            if (const DenseMatrix* A = source_.dense()) {
                y -= x[i] * A->row(i).transpose();
                z += std::abs(x[i]) * A->row(i).transpose().cwiseAbs();
            } else if (const Vector* d = source_.diagonal_entries()) {
                y[i] -= (*d)[i] * x[i];
                z[i] += std::abs((*d)[i] * x[i]);
            } else {
                const auto end = start_[static_cast<std::size_t>(i) + 1];
                for (auto k = start_[static_cast<std::size_t>(i)]; k < end; ++k) {
                    const double term = value_[static_cast<std::size_t>(k)] * x[i];
                    y[column_[static_cast<std::size_t>(k)]] -= term;
                    z[column_[static_cast<std::size_t>(k)]] += std::abs(term);
                }
            }
        }
    }

private:
    Matrix source_;
    std::vector<int> start_, column_;
    std::vector<double> value_;
};

}  // namespace

double KktResiduals::largest() const {
    double worst = 0;
    for (const double r : {stationarity, penetration, negativity, complementarity})
        worst = std::isnan(r) ? std::numeric_limits<double>::infinity() : std::max(worst, r);
    return worst;
}

struct KktCertificate::Work {
    Work(const Matrix& A_, const Matrix& B_)
        : A(A_), B(B_), force(A_.rows()), force_scale(A_.rows()), gap(B_.rows()), gap_scale(B_.rows()) {}
    Rows A, B;
    Vector force, force_scale, gap, gap_scale;
};

KktCertificate::KktCertificate(const Matrix& A, const Matrix& B) : work_(std::make_unique<Work>(A, B)) {}
KktCertificate::~KktCertificate() = default;
KktCertificate::KktCertificate(KktCertificate&&) noexcept = default;
KktCertificate& KktCertificate::operator=(KktCertificate&&) noexcept = default;

KktResiduals KktCertificate::operator()(const ConstVectorRef& b, const ConstVectorRef& c, const ConstVectorRef& u,
                                        const ConstVectorRef& lambda) const {
    Work& w = *work_;
    w.A.multiply(u, w.force, w.force_scale);
    w.B.subtract_transposed(lambda, w.force, w.force_scale);
    double residual = 0, force_scale = 0;
    bool finite = true;
    for (Index i = 0; i < w.force.size(); ++i) {
        const double r = std::abs(w.force[i] - b[i]);
        const double s = w.force_scale[i] + std::abs(b[i]);
        finite &= std::isfinite(s);
        residual = std::max(residual, r);
        force_scale = std::max(force_scale, s);
    }
    KktResiduals kkt;
    kkt.stationarity = finite ? ratio(residual, force_scale) : std::numeric_limits<double>::infinity();
    const Index m = w.gap.size();
    if (m == 0) return kkt;

    w.B.multiply(u, w.gap, w.gap_scale);
    double gap_scale = 0, multiplier_scale = 0, penetration = 0, negativity = 0;
    for (Index i = 0; i < m; ++i) {
        multiplier_scale = std::max(multiplier_scale, std::abs(lambda[i]));
        negativity = std::max(negativity, -lambda[i]);
        if (c[i] == -std::numeric_limits<double>::infinity()) {
            // A row that is switched off may carry no force: any multiplier on it is a complementarity fault.
            if (lambda[i] != 0) kkt.complementarity = std::numeric_limits<double>::infinity();
            continue;
        }
        w.gap[i] -= c[i];
        gap_scale = std::max(gap_scale, w.gap_scale[i] + std::abs(c[i]));
        penetration = std::max(penetration, -w.gap[i]);
    }
    kkt.penetration = ratio(penetration, gap_scale);
    kkt.negativity = ratio(negativity, multiplier_scale);
    if (multiplier_scale > 0 && gap_scale > 0)
        for (Index i = 0; i < m; ++i)
            if (lambda[i] > 0 && c[i] != -std::numeric_limits<double>::infinity())
                kkt.complementarity =
                    std::max(kkt.complementarity, std::min(w.gap[i] / gap_scale, lambda[i] / multiplier_scale));
    return kkt;
}

KktResiduals kkt_residuals(const Matrix& A, const Matrix& B, const Vector& b, const Vector& c, const Vector& u,
                           const Vector& lambda) {
    return KktCertificate(A, B)(b, c, u, lambda);
}

}  // namespace tact
