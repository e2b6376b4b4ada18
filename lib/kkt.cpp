#include "tact/lib/kkt.hpp"

#include <cmath>
#include <vector>

#include "tact/lib/row_runs.hpp"

namespace tact {
namespace {

constexpr Index block_rows = RowRuns::block_rows;
using Buffer = double[block_rows];

/// Both arguments are max norms; 0/0 = 0.
double ratio(double numerator, double denominator) {
    if (numerator == 0) return 0;
    return numerator / denominator;
}

/// Running max of entries that are not negative; NaN counts as infinity. Eight lanes, so that it vectorises.
class Largest {
public:
    template <class EntryAt> void take(Index count, EntryAt entry_at) {
        const Index whole = count / lanes * lanes;
        for (Index i = 0; i < whole; i += lanes)
            for (Index l = 0; l < lanes; ++l) raise(entry_at(i + l), l);
        for (Index i = whole; i < count; ++i) raise(entry_at(i), 0);
    }
    double value() const {
        double largest = 0;
        for (Index l = 0; l < lanes; ++l) {
            if (std::isnan(sum_[l])) return infinity;
            largest = std::max(largest, best_[l]);
        }
        return largest;
    }

private:
    static constexpr Index lanes = 8;
    void raise(double v, Index lane) {
        best_[lane] = v > best_[lane] ? v : best_[lane];
        sum_[lane] += v;  // keeps every NaN; a comparison drops it
    }
    double best_[lanes] = {}, sum_[lanes] = {};
};

/// The rows of A in blocks, for A x and |A||x| taken together.
class Rows {
public:
    explicit Rows(const Matrix& A) : size_(A.rows()) {
        if (A.dense())
            dense_ = A;
        else
            sparse_ = RowRuns(A.to_sparse().transpose());
    }
    static Rows transposed(const Matrix& A) {
        if (const DenseMatrix* dense = A.dense()) return Rows(Matrix(DenseMatrix(dense->transpose())));
        return Rows(Matrix(SparseMatrix(A.to_sparse().transpose())));
    }
    Index size() const { return size_; }

    /// sum += sign A x and size += |A||x| on the `count` rows of a block.
    void add(Index block, Index count, double sign, const double* x, double* __restrict sum,
             double* __restrict size) const {
        const DenseMatrix* A = dense_.dense();
        if (!A) return sparse_.add(block, sign, x, sum, size);
        for (Index j = 0; j < A->cols(); ++j) {
            if (x[j] == 0) continue;  // multipliers mostly are
            const double* column = &A->coeffRef(block * block_rows, j);
            for (Index i = 0; i < count; ++i) {
                const double term = column[i] * x[j];
                sum[i] += sign * term;
                size[i] += std::abs(term);
            }
        }
    }

private:
    Index size_;
    RowRuns sparse_;
    Matrix dense_;
};

template <class Each> void for_each_block(Index rows, Each each) {
    for (Index block = 0; block * block_rows < rows; ++block)
        each(block, block * block_rows, std::min(block_rows, rows - block * block_rows));
}

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
    Work(const Matrix& A_, const Matrix& B_) : A(A_), B(B_), B_transposed(Rows::transposed(B_)) {}
    Rows A, B, B_transposed;
    /// Of the rows with a multiplier.
    struct Touch {
        double gap, lambda;
    };
    std::vector<Touch> touches;
};

KktCertificate::KktCertificate(const Matrix& A, const Matrix& B) : work_(std::make_unique<Work>(A, B)) {}
KktCertificate::~KktCertificate() = default;
KktCertificate::KktCertificate(KktCertificate&&) noexcept = default;
KktCertificate& KktCertificate::operator=(KktCertificate&&) noexcept = default;

KktResiduals KktCertificate::operator()(const ConstVectorRef& b, const ConstVectorRef& c, const ConstVectorRef& u,
                                        const ConstVectorRef& lambda) const {
    Work& w = *work_;
    alignas(64) Buffer sum, size;
    Largest residual, force_scale;
    for_each_block(w.A.size(), [&](Index block, Index first, Index count) {
        for (Index i = 0; i < count; ++i) {
            sum[i] = -b[first + i];
            size[i] = std::abs(b[first + i]);
        }
        w.A.add(block, count, 1, u.data(), sum, size);
        w.B_transposed.add(block, count, -1, lambda.data(), sum, size);
        residual.take(count, [&](Index i) { return std::abs(sum[i]); });
        force_scale.take(count, [&](Index i) { return size[i]; });
    });
    KktResiduals kkt;
    kkt.absolute.stationarity = residual.value();
    kkt.stationarity = std::isfinite(force_scale.value()) ? ratio(residual.value(), force_scale.value()) : infinity;

    Largest penetration, gap_scale, negativity, multiplier_scale;
    w.touches.clear();
    for_each_block(w.B.size(), [&](Index block, Index first, Index count) {
        const double* bound = c.data() + first;
        const double* force = lambda.data() + first;
        for (Index i = 0; i < count; ++i) {
            sum[i] = -bound[i];  // +infinity where a row is off
            size[i] = std::abs(bound[i]);
        }
        w.B.add(block, count, 1, u.data(), sum, size);
        penetration.take(count, [&](Index i) { return !(sum[i] >= 0) ? -sum[i] : 0.0; });
        gap_scale.take(count, [&](Index i) { return bound[i] == -infinity ? 0.0 : size[i]; });
        negativity.take(count, [&](Index i) { return !(force[i] >= 0) ? -force[i] : 0.0; });
        Largest multiplier;
        multiplier.take(count, [&](Index i) { return std::abs(force[i]); });
        const double largest = multiplier.value();
        if (largest == 0) return;
        multiplier_scale.take(1, [largest](Index) { return largest; });
        for (Index i = 0; i < count; ++i)
            if (force[i] != 0) w.touches.push_back({sum[i], force[i]});
    });
    const double gaps = gap_scale.value(), multipliers = multiplier_scale.value();
    kkt.absolute.penetration = penetration.value();
    kkt.absolute.negativity = negativity.value();
    kkt.penetration = ratio(penetration.value(), gaps);
    kkt.negativity = ratio(negativity.value(), multipliers);
    for (const auto& [gap, force] : w.touches) {
        if (gap == infinity) {
            // A row that is switched off may carry no force: any multiplier on it is a complementarity fault.
            kkt.complementarity = infinity;
        } else if (force > 0 && gaps > 0) {
            const double share = force / multipliers;
            kkt.complementarity = std::max(kkt.complementarity, std::min(gap / gaps, share));
            kkt.absolute.complementarity = std::max(kkt.absolute.complementarity, gap * share);
        }
    }
    return kkt;
}

KktResiduals kkt_residuals(const Matrix& A, const Matrix& B, const Vector& b, const Vector& c, const Vector& u,
                           const Vector& lambda) {
    return KktCertificate(A, B)(b, c, u, lambda);
}

}  // namespace tact
