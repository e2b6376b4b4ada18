#include "kkt.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>
#include <type_traits>
#include <vector>

#include "algebra/lane_ranges.hpp"
#include "algebra/row_runs.hpp"
#include "errors.hpp"

namespace tact {
namespace {

constexpr Index block_rows = RowRuns::block_rows;
using Buffer = double[block_rows];

/// A bound beyond this is a way to write none.
constexpr double pseudo_infinite = 1e19;

/// Both arguments are max norms; 0/0 = 0, and what has decayed into underflow counts as zero.
double ratio(double numerator, double denominator) {
    if (numerator == 0) return 0;
    return numerator / std::max(denominator, underflow);
}

using namespace lane_ranges;

/// The rows of A in blocks, for A x and |A||x| taken together.
class Rows {
public:
    explicit Rows(const Matrix& A) : size_(A.rows()) {
        if (A.dense() || A.diagonal_entries())
            direct_ = A;
        else if (const SparseMatrix* S = A.sparse(); S && !A.is_symmetric(0))
            sparse_ = RowRuns(S->transpose());
        else
            sparse_ = columns_of(A);
    }
    static Rows transposed(const Matrix& A) {
        if (const DenseMatrix* dense = A.dense()) return Rows(Matrix(DenseMatrix(dense->transpose())));
        return Rows(A.cols(), columns_of(A));
    }
    Index size() const { return size_; }

    /// sum += sign A x and size += |A||x| on the `count` rows of a block.
    void add(Index block, Index count, double sign, const double* x, double* __restrict sum,
             double* __restrict size) const {
        if (const DenseMatrix* A = direct_.dense())
            return add_columns(
                *A, block, count, sign, x, A->cols(), [](Index j) { return j; }, sum, size);
        const Vector* diagonal = direct_.diagonal_entries();
        if (!diagonal) return sparse_.add(block, sign, x, sum, size);
        for (Index i = 0; i < count; ++i) {
            const double term = (*diagonal)[block * block_rows + i] * x[block * block_rows + i];
            sum[i] += sign * term;
            size[i] += std::abs(term);
        }
    }
    /// The same from the listed columns alone, of a dense matrix.
    void add(Index block, Index count, double sign, const double* x, std::span<const Index> columns, double* sum,
             double* size) const {
        add_columns(
            *direct_.dense(), block, count, sign, x, static_cast<Index>(columns.size()),
            [&](Index k) { return columns[static_cast<std::size_t>(k)]; }, sum, size);
    }
    const DenseMatrix* dense() const { return direct_.dense(); }
    const Vector* diagonal() const { return direct_.diagonal_entries(); }

private:
    // Four columns a pass, because each pass loads and stores the sums; multipliers mostly are zero.
    template <class Column>
    static void add_columns(const DenseMatrix& A, Index block, Index count, double sign, const double* x,
                            Index columns, Column column_at, double* __restrict sum, double* __restrict size) {
        for (Index next = 0; next < columns;) {
            const double* column[4];
            double factor[4] = {};
            int taken = 0;
            for (; next < columns && taken < 4; ++next)
                if (const Index j = column_at(next); x[j] != 0) {
                    column[taken] = A.data() + j * A.rows() + block * block_rows;
                    factor[taken++] = x[j];
                }
            if (taken == 0) return;
            for (int k = taken; k < 4; ++k) column[k] = column[0];
            for (Index i = 0; i < count; ++i) {
                double total = 0, absolute = 0;
                for (int k = 0; k < 4; ++k) {
                    const double term = column[k][i] * factor[k];
                    total += term;
                    absolute += std::abs(term);
                }
                sum[i] += sign * total;
                size[i] += absolute;
            }
        }
    }
    Rows(Index size, RowRuns sparse) : size_(size), sparse_(std::move(sparse)) {}
    /// The rows of A', and of A where both are the same. A is not dense.
    static RowRuns columns_of(const Matrix& A) { return A.sparse() ? RowRuns(*A.sparse()) : RowRuns(A.to_sparse()); }

    Index size_;
    RowRuns sparse_;
    Matrix direct_;  // dense or diagonal; else empty
};

/// A column of B' and its multiplier.
struct Force {
    const double* column;
    double multiplier;
};

/// Of the rows with a multiplier.
struct Touch {
    double gap, lambda;
};

struct RowProduct {
    double sum, size;
};

/// b'u and |b|'|u|.
RowProduct row_product(const double* b, const double* u, Index n) {
    Lanes sum[2] = {}, size[2] = {};
    const auto take = [&](const Lanes& term, int way) {
        sum[way] += term;
        size[way] += size_of(term);
    };
    Index i = 0;
    for (; i + 2 * lanes <= n; i += 2 * lanes) {
        take(load(b + i) * load(u + i), 0);
        take(load(b + i + lanes) * load(u + i + lanes), 1);
    }
    if (i + lanes <= n) {
        take(load(b + i) * load(u + i), 0);
        i += lanes;
    }
    RowProduct product{total(sum[0] + sum[1]), total(size[0] + size[1])};
    for (; i < n; ++i) {
        product.sum += b[i] * u[i];
        product.size += std::abs(b[i] * u[i]);
    }
    return product;
}

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

void KktResiduals::raise_to(const KktResiduals& other) {
    const auto raise = [](double& worst, double b) { worst = std::isnan(b) ? infinity : std::max(worst, b); };
    raise(stationarity, other.stationarity);
    raise(penetration, other.penetration);
    raise(negativity, other.negativity);
    raise(complementarity, other.complementarity);
    raise(absolute.stationarity, other.absolute.stationarity);
    raise(absolute.penetration, other.absolute.penetration);
    raise(absolute.negativity, other.absolute.negativity);
    raise(absolute.complementarity, other.absolute.complementarity);
}

bool KktResiduals::within(double tolerance, double gap_size) const {
    constexpr double rounding = 1e-13;
    const double floor = gap_size < pseudo_infinite ? rounding * gap_size : 0;
    const auto small = [&](double scaled, double gap) { return scaled <= tolerance || gap <= floor; };
    return stationarity <= tolerance && negativity <= tolerance && small(penetration, absolute.penetration) &&
           small(complementarity, absolute.complementarity);
}

struct KktCertificate::Work {
    Work(const Matrix& A_, const Matrix& B_) : A(A_), B(B_), B_transposed(Rows::transposed(B_)) {
        const Vector* d = B_.diagonal_entries();
        if (d && d->size() > 0 && (d->array() == (*d)[0]).all()) bounds = (*d)[0];
    }
    Rows A, B, B_transposed;
    std::optional<double> bounds;  ///< B is so many times the identity
    std::vector<Touch> touches;
    std::vector<Force> forces;
};

KktCertificate::KktCertificate(const Matrix& A, const Matrix& B) : work_(std::make_unique<Work>(A, B)) {}
KktCertificate::~KktCertificate() = default;
KktCertificate::KktCertificate(KktCertificate&&) noexcept = default;
KktCertificate& KktCertificate::operator=(KktCertificate&&) noexcept = default;

namespace {

/// |D u - b - B'lambda| and |D||u| + |b| + |B'||lambda|, in one pass; no matrix is formed of the few columns that count.
void take_diagonal(Index n, const double* d, const double* u, const double* b, const std::vector<Force>& forces,
                   Largest& residual, Largest& force_scale) {
    const auto take = [&](auto load_from, int way) {
        const Lanes term = load_from(d) * load_from(u), load_b = load_from(b);
        Lanes sum = term - load_b, size = size_of(term) + size_of(load_b);
        for (const Force& force : forces) {
            const Lanes pressed = load_from(force.column) * force.multiplier;
            sum -= pressed;
            size += size_of(pressed);
        }
        residual.take(sum, way);
        force_scale.take(size, way);
    };
    const auto take_at = [&](Index i, int way) { take([i](const double* x) { return load(x + i); }, way); };
    if (n < lanes) return take([n](const double* x) { return load(x, n); }, 0);
    Index i = 0;
    for (; i + 2 * lanes <= n; i += 2 * lanes) {
        take_at(i, 0);
        take_at(i + lanes, 1);
    }
    // The ends of what is left, some numbers twice: a maximum does not mind.
    if (i + lanes <= n) take_at(i, 0);
    if (i < n) take_at(n - lanes, 1);
}

void set_stationarity(KktResiduals& kkt, const Largest& residual, const Largest& force_scale) {
    const double forces = force_scale.value();
    kkt.absolute.stationarity = residual.value();
    kkt.stationarity = std::isfinite(forces) ? ratio(kkt.absolute.stationarity, forces) : infinity;
}

/// |A u + r - b - B'lambda|, where add_forces adds -B'lambda block by block; into `kkt`. No r: nullptr.
template <class AddForces>
void take_stationarity(KktResiduals& kkt, const Rows& A, const ConstVectorRef& b, const ConstVectorRef& u,
                       const double* r, AddForces add_forces) {
    alignas(64) Buffer sum, size;
    Largest residual, force_scale;
    for_each_block(A.size(), [&](Index block, Index first, Index count) {
        for (Index i = 0; i < count; ++i) {
            sum[i] = -b[first + i];
            size[i] = std::abs(b[first + i]);
        }
        if (r)
            for (Index i = 0; i < count; ++i) {
                sum[i] += r[first + i];
                size[i] += std::abs(r[first + i]);
            }
        A.add(block, count, 1, u.data(), sum, size);
        add_forces(block, count, sum, size);
        residual.take(sum, count);
        force_scale.take(size, count);
    });
    set_stationarity(kkt, residual, force_scale);
}

/// The openings of bounds on unknowns, and their scale without bounds that mean "none", in one pass.
void take_bounds(Index count, double factor, const double* u, const double* bound, double* opening, Range& gap,
                 Range& gap_scale) {
    const auto take = [&](Index i, Index some, int way) {
        const Lanes x = some == lanes ? load(u + i) : load(u + i, some);
        const Lanes c = some == lanes ? load(bound + i) : load(bound + i, some);
        const Lanes term = factor * x, open = term - c;
        std::memcpy(opening + i, &open, sizeof open);  // a block's buffer holds whole lanes
        gap.take(open, way);
        gap_scale.take(c <= -pseudo_infinite ? Lanes{} : size_of(term) + size_of(c), way);
    };
    Index i = 0;
    for (; i + 2 * lanes <= count; i += 2 * lanes) {
        take(i, lanes, 0);
        take(i + lanes, lanes, 1);
    }
    for (; i < count; i += lanes) take(i, std::min(lanes, count - i), 0);
}

void take_rows(KktResiduals& kkt, const Range& gap, const Range& gap_scale, const Range& multiplier,
               const std::vector<Touch>& touches) {
    const double gaps = gap_scale.highest(), multipliers = multiplier.largest();
    kkt.absolute.penetration = -gap.lowest();
    kkt.absolute.negativity = -multiplier.lowest();
    // Where terms overflow nothing can be said of a gap.
    kkt.penetration = std::isfinite(gaps) ? ratio(kkt.absolute.penetration, gaps) : infinity;
    kkt.negativity = ratio(kkt.absolute.negativity, multipliers);
    for (const auto& [opening, force] : touches) {
        if (opening == infinity) {
            // A row that is switched off may carry no force: any multiplier on it is a complementarity fault.
            kkt.complementarity = infinity;
        } else if (force > 0 && gaps > 0) {
            const double share = force / multipliers;
            kkt.complementarity = std::max(kkt.complementarity, std::min(opening / gaps, share));
            kkt.absolute.complementarity = std::max(kkt.absolute.complementarity, opening * share);
        }
    }
}

}  // namespace

KktResiduals KktCertificate::operator()(const ConstVectorRef& b, const ConstVectorRef& c, const ConstVectorRef& u,
                                        const ConstVectorRef& lambda) const {
    return evaluate(b, c, u, lambda, nullptr);
}

void KktCertificate::row_products(const ConstVectorRef& u, Vector& moved, Vector& size) const {
    const Rows& B = work_->B;
    moved.setZero(B.size());
    size.setZero(B.size());
    for_each_block(B.size(), [&](Index block, Index first, Index count) {
        B.add(block, count, 1, u.data(), moved.data() + first, size.data() + first);
    });
}

KktResiduals KktCertificate::evaluate(const ConstVectorRef& b, const ConstVectorRef& c, const ConstVectorRef& u,
                                      const ConstVectorRef& lambda, const double* r) const {
    Work& w = *work_;
    KktResiduals kkt;
    Range gap, gap_scale, multiplier;
    multiplier.take(lambda.data(), lambda.size());
    const bool touching = multiplier.largest() != 0;
    if (const Vector* diagonal = w.A.diagonal(); diagonal && !touching && !r) {
        Largest residual, force_scale;
        take_diagonal(u.size(), diagonal->data(), u.data(), b.data(), {}, residual, force_scale);
        set_stationarity(kkt, residual, force_scale);
    } else {
        take_stationarity(kkt, w.A, b, u, r, [&](Index block, Index count, double* sum, double* size) {
            if (touching) w.B_transposed.add(block, count, -1, lambda.data(), sum, size);
        });
    }
    alignas(64) Buffer sum, size;
    w.touches.clear();
    for_each_block(w.B.size(), [&](Index block, Index first, Index count) {
        const double* bound = c.data() + first;
        const double* force = lambda.data() + first;
        if (w.bounds) {
            take_bounds(count, *w.bounds, u.data() + first, bound, sum, gap, gap_scale);
        } else {
            for (Index i = 0; i < count; ++i) {
                sum[i] = -bound[i];  // +infinity where a row is off
                size[i] = std::abs(bound[i]);
            }
            w.B.add(block, count, 1, u.data(), sum, size);
            for (Index i = 0; i < count; ++i) size[i] = bound[i] <= -pseudo_infinite ? 0.0 : size[i];
            gap.take(sum, count);
            gap_scale.take(size, count);
        }
        Range here;
        if (touching) here.take(force, count);
        if (here.largest() == 0) return;
        for (Index i = 0; i < count; ++i)
            if (force[i] != 0) w.touches.push_back({sum[i], force[i]});
    });
    take_rows(kkt, gap, gap_scale, multiplier, w.touches);
    return kkt;
}

KktResiduals KktCertificate::operator()(const ConstVectorRef& b, const ConstVectorRef& c, const ConstVectorRef& u,
                                        const ConstVectorRef& lambda, std::span<const Index> rows) const {
    Work& w = *work_;
    const DenseMatrix* Bt = w.B_transposed.dense();
    if (!Bt) throw InputError("KktCertificate: B is not dense, expected dense where rows are listed");
    KktResiduals kkt;
    if (const Vector* d = w.A.diagonal()) {
        w.forces.clear();
        for (const Index i : rows)
            if (lambda[i] != 0) w.forces.push_back({Bt->col(i).data(), lambda[i]});
        Largest residual, force_scale;
        take_diagonal(d->size(), d->data(), u.data(), b.data(), w.forces, residual, force_scale);
        set_stationarity(kkt, residual, force_scale);
    } else {
        take_stationarity(kkt, w.A, b, u, nullptr, [&](Index block, Index count, double* sum, double* size) {
            w.B_transposed.add(block, count, -1, lambda.data(), rows, sum, size);
        });
    }
    if (rows.empty()) return kkt;
    alignas(64) Buffer opening, size, force;
    Range gap, gap_scale, multiplier;
    w.touches.clear();
    for (std::size_t first = 0; first < rows.size(); first += block_rows) {
        const std::span<const Index> some =
            rows.subspan(first, std::min<std::size_t>(block_rows, rows.size() - first));
        for (std::size_t k = 0; k < some.size(); ++k) {
            const Index i = some[k];
            const RowProduct moved = row_product(Bt->col(i).data(), u.data(), u.size());
            opening[k] = moved.sum - c[i];
            size[k] = c[i] <= -pseudo_infinite ? 0.0 : moved.size + std::abs(c[i]);
            force[k] = lambda[i];
            if (lambda[i] != 0) w.touches.push_back({opening[k], lambda[i]});
        }
        const Index count = static_cast<Index>(some.size());
        gap.take(opening, count);
        gap_scale.take(size, count);
        multiplier.take(force, count);
    }
    take_rows(kkt, gap, gap_scale, multiplier, w.touches);
    return kkt;
}

KktResiduals kkt_residuals(const Matrix& A, const Matrix& B, const Vector& b, const Vector& c, const Vector& u,
                           const Vector& lambda) {
    return KktCertificate(A, B)(b, c, u, lambda);
}

}  // namespace tact
