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

/// Max of non-negative entries, 0 of none; NaN counts as infinity. Eight running maxima, so that it vectorises.
template <class Expression> double size_of(const Expression& x) {
    constexpr Index lanes = 8;
    double best[lanes] = {}, sum[lanes] = {};  // a sum keeps every NaN, a comparison drops it
    const Eigen::internal::evaluator<Expression> entry(x);
    const Index whole = x.size() / lanes * lanes;
    for (Index i = 0; i < whole; i += lanes)
        for (Index l = 0; l < lanes; ++l) {
            const double v = entry.coeff(i + l);
            best[l] = v > best[l] ? v : best[l];
            sum[l] += v;
        }
    for (Index i = whole; i < x.size(); ++i) {
        const double v = entry.coeff(i);
        best[0] = v > best[0] ? v : best[0];
        sum[0] += v;
    }
    for (Index l = 0; l < lanes; ++l) {
        if (std::isnan(sum[l])) return infinity;
        best[0] = std::max(best[0], best[l]);
    }
    return best[0];
}

/// Rows of a matrix for two products in one pass: y = A x and z = |A||x|. Sparse rows are taken in blocks; where a block
/// has few distinct offsets column - row (any mesh numbered along its lines) it is stored by diagonals, whose products
/// vectorise, else row by row.
class Rows {
public:
    explicit Rows(const Matrix& A) : source_(A) {
        if (const DenseMatrix* dense = A.dense()) {
            absolute_ = dense->cwiseAbs();
            transposed_ = dense->transpose();
        }
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
        for (Index first = 0; first < A.rows(); first += block_rows) find_diagonals(first);
    }

    /// y = A x and z = |A||x|.
    void multiply(const ConstVectorRef& x, VectorRef y, VectorRef z) const {
        if (source_.sparse()) {
            for (std::size_t block = 0; block < diagonals_.size(); ++block) {
                const Index first = static_cast<Index>(block) * block_rows;
                const Index count = std::min(block_rows, source_.rows() - first);
                if (diagonals_[block].empty())
                    multiply_rows(first, count, x.data(), y.data(), z.data());
                else
                    multiply_diagonals(diagonals_[block], first, count, x.data(), y.data(), z.data());
            }
        } else {
            multiply(x, y);
            multiply_absolute(x, z);
        }
    }

    /// y = A x.
    void multiply(const ConstVectorRef& x, VectorRef y) const {
        if (const DenseMatrix* A = source_.dense())
            y.noalias() = *A * x;
        else if (const Vector* d = source_.diagonal_entries())
            y = d->cwiseProduct(x);
        else
            for (Index i = 0; i < source_.rows(); ++i) {
                double sum = 0;
                for (auto k = begin_of(i); k < begin_of(i + 1); ++k) sum += value_[k] * x[column_[k]];
                y[i] = sum;
            }
    }

    /// z = |A||x|.
    void multiply_absolute(const ConstVectorRef& x, VectorRef z) const {
        if (source_.dense()) {
            size_ = x.cwiseAbs();
            z.noalias() = absolute_ * size_;
        } else if (const Vector* d = source_.diagonal_entries()) {
            z = d->cwiseProduct(x).cwiseAbs();
        } else {
            for (Index i = 0; i < source_.rows(); ++i) {
                double sum = 0;
                for (auto k = begin_of(i); k < begin_of(i + 1); ++k) sum += std::abs(value_[k] * x[column_[k]]);
                z[i] = sum;
            }
        }
    }

    /// y -= A' x and z += |A'||x|, skipping the zeros of x: multipliers are mostly zero.
    void subtract_transposed(const ConstVectorRef& x, VectorRef y, VectorRef z) const {
        if (const Vector* d = source_.diagonal_entries()) {
            y -= d->cwiseProduct(x);
            z += d->cwiseProduct(x).cwiseAbs();
            return;
        }
        const bool dense = source_.dense() != nullptr;
        for (Index i = 0; i < source_.rows(); ++i) {
            if (x[i] == 0) continue;
            if (dense) {
                y -= x[i] * transposed_.col(i);
                z += std::abs(x[i]) * transposed_.col(i).cwiseAbs();
                continue;
            }
            for (auto k = begin_of(i); k < begin_of(i + 1); ++k) {
                const double term = value_[k] * x[i];
                y[column_[k]] -= term;
                z[column_[k]] += std::abs(term);
            }
        }
    }

private:
    static constexpr Index block_rows = 512;

    struct Diagonal {
        Index offset;                // column - row
        Index first = 0, count = 0;  // rows of the block where it is inside the matrix
        std::vector<double> values;
    };

    std::size_t begin_of(Index row) const { return static_cast<std::size_t>(start_[static_cast<std::size_t>(row)]); }

    void find_diagonals(Index first) {
        const Index count = std::min(block_rows, source_.rows() - first);
        diagonals_.emplace_back();
        auto& diagonals = diagonals_.back();
        const auto entries = begin_of(first + count) - begin_of(first);
        for (Index i = first; i < first + count; ++i)
            for (auto k = begin_of(i); k < begin_of(i + 1); ++k) {
                const Index offset = column_[k] - i;
                auto found = std::find_if(diagonals.begin(), diagonals.end(),
                                          [&](const Diagonal& d) { return d.offset == offset; });
                if (found == diagonals.end()) {
                    // Zeros are multiplied too: not worth it beyond twice the work.
                    if ((diagonals.size() + 1) * static_cast<std::size_t>(count) > 2 * entries + 512) {
                        diagonals.clear();
                        return;
                    }
                    const Index low = std::max<Index>(0, -offset - first);
                    const Index high = std::min(count, source_.cols() - offset - first);
                    diagonals.push_back(
                        {offset, low, high - low, std::vector<double>(static_cast<std::size_t>(high - low))});
                    found = diagonals.end() - 1;
                }
                found->values[static_cast<std::size_t>(i - first - found->first)] += value_[k];
            }
    }

    static void multiply_diagonals(const std::vector<Diagonal>& diagonals, Index first, Index count, const double* x,
                                   double* y, double* z) {
        std::fill_n(y + first, count, 0.0);
        std::fill_n(z + first, count, 0.0);
        for (const Diagonal& d : diagonals) {
            double* __restrict sum = y + first + d.first;
            double* __restrict size = z + first + d.first;
            const double* __restrict value = d.values.data();
            const double* __restrict operand = x + first + d.first + d.offset;
            for (Index i = 0; i < d.count; ++i) {
                const double term = value[i] * operand[i];
                sum[i] += term;
                size[i] += std::abs(term);
            }
        }
    }

    void multiply_rows(Index first, Index count, const double* x, double* y, double* z) const {
        for (Index i = first; i < first + count; ++i) {
            double sum = 0, size = 0;
            for (auto k = begin_of(i); k < begin_of(i + 1); ++k) {
                const double term = value_[k] * x[column_[k]];
                sum += term;
                size += std::abs(term);
            }
            y[i] = sum;
            z[i] = size;
        }
    }

    Matrix source_;
    std::vector<int> start_, column_;
    std::vector<double> value_;
    std::vector<std::vector<Diagonal>> diagonals_;  // by block; none: row by row
    DenseMatrix absolute_, transposed_;             // of a dense matrix
    mutable Vector size_;
};

}  // namespace

double KktResiduals::largest() const {
    double worst = 0;
    for (const double r : {stationarity, penetration, negativity, complementarity})
        worst = std::isnan(r) ? infinity : std::max(worst, r);
    return worst;
}

bool KktResiduals::within(double tolerance, double gap_size) const {
    const auto small = [&](double scaled, double gap) { return scaled <= tolerance || gap <= tolerance * gap_size; };
    return stationarity <= tolerance && negativity <= tolerance && small(penetration, absolute.penetration) &&
           small(complementarity, absolute.complementarity);
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
    const auto residuals = (w.force - b).cwiseAbs();
    const double residual = size_of(residuals);
    const double force_scale = size_of(w.force_scale + b.cwiseAbs());
    const bool finite = std::isfinite(force_scale);
    KktResiduals kkt;
    kkt.absolute.stationarity = residual;
    kkt.stationarity = finite ? ratio(residual, force_scale) : infinity;
    const Index m = w.gap.size();
    if (m == 0) return kkt;

    w.B.multiply(u, w.gap);
    w.gap -= c;  // +infinity where a row is off
    const double penetration = size_of((-w.gap).cwiseMax(0.0));
    const double multiplier_scale = size_of(lambda.cwiseAbs());
    kkt.absolute.penetration = penetration;
    if (penetration == 0 && multiplier_scale == 0) return kkt;

    w.B.multiply_absolute(u, w.gap_scale);
    const auto off = c.array() == -infinity;
    const double gap_scale = size_of(off.select(0.0, w.gap_scale.array() + c.array().abs()));
    const double negativity = size_of((-lambda).cwiseMax(0.0));
    kkt.absolute.negativity = negativity;
    kkt.penetration = ratio(penetration, gap_scale);
    kkt.negativity = ratio(negativity, multiplier_scale);
    for (Index i = 0; i < m; ++i) {
        if (lambda[i] == 0) continue;
        if (c[i] == -infinity) {
            // A row that is switched off may carry no force: any multiplier on it is a complementarity fault.
            kkt.complementarity = infinity;
        } else if (lambda[i] > 0 && gap_scale > 0) {
            const double share = lambda[i] / multiplier_scale;
            kkt.complementarity = std::max(kkt.complementarity, std::min(w.gap[i] / gap_scale, share));
            kkt.absolute.complementarity = std::max(kkt.absolute.complementarity, w.gap[i] * share);
        }
    }
    return kkt;
}

KktResiduals kkt_residuals(const Matrix& A, const Matrix& B, const Vector& b, const Vector& c, const Vector& u,
                           const Vector& lambda) {
    return KktCertificate(A, B)(b, c, u, lambda);
}

}  // namespace tact
