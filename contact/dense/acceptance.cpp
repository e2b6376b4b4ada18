#include "acceptance.hpp"

#include <algorithm>
#include <cmath>

namespace tact {
namespace {

/// Times the places that rows speak of, where no solution is looked for.
constexpr double far = 1e4;
/// Of the reach: what rounding leaves of a gap whose exact value is zero.
constexpr double rounding = 4e-15;

/// sum += sign M x and size += |M||x|.
void add_product(const Matrix& M, double sign, const ConstVectorRef& x, Vector& sum, Vector& size) {
    M.multiply(x, sum, sign, 1);
    const Vector length = x.cwiseAbs();
    if (const DenseMatrix* dense = M.dense())
        size += dense->cwiseAbs() * length;
    else if (const Vector* diagonal = M.diagonal_entries())
        size += diagonal->cwiseAbs().cwiseProduct(length);
    else
        size += M.sparse()->cwiseAbs() * length;
}

}  // namespace

Acceptance::Acceptance(const Matrix& A, const Matrix& B) : certificate_(A, B), A_(A), weight_(B.rows()) {
    stiffness_ = A.main_diagonal().unaryExpr([](double a) { return a > 0 ? std::sqrt(a) : 1.0; });
    uneven_ = stiffness_.maxCoeff() > 10 * stiffness_.minCoeff();
    Bt_ = B.diagonal_entries() ? B.to_sparse() : SparseMatrix(B.to_sparse().transpose());
    for (Index i = 0; i < weight_.size(); ++i) {
        weight_[i] = 0;
        for (SparseMatrix::InnerIterator it(Bt_, i); it; ++it)
            weight_[i] += std::abs(it.value()) / stiffness_[it.row()];
    }
}

void Acceptance::certify(ContactReport& report, const ConstVectorRef& b, const ConstVectorRef& c,
                         const ConstVectorRef& u, const ConstVectorRef& lambda, double tolerance, double reach,
                         ContactPoint point) const {
    // Before the certificate, which begins with lambda too: at full size vectors come from memory.
    const bool touching = !(lambda.lpNorm<1>() == 0);
    report.active = touching ? (lambda.array() > 0).count() : 0;
    report.kkt = certificate_(b, c, u, lambda);
    if (!(report.kkt.stationarity <= tolerance && report.kkt.negativity <= tolerance &&
          (!uneven_ || balances(b, u, lambda, 10 * tolerance)) &&
          rows_are_met(report.kkt, b, c, u, lambda, tolerance, reach))) {
        report.outcome = Outcome::inaccurate;
        return;
    }
    point.u = u;
    if (lambda.data() != point.lambda.data()) point.lambda = lambda;
}

bool Acceptance::balances(const ConstVectorRef& b, const ConstVectorRef& u, const ConstVectorRef& lambda,
                          double tolerance) const {
    Vector force = -b, size = b.cwiseAbs();
    add_product(A_, 1, u, force, size);
    for (Index i = 0; i < lambda.size(); ++i) {
        if (lambda[i] == 0) continue;
        for (SparseMatrix::InnerIterator it(Bt_, i); it; ++it) {
            force[it.row()] -= it.value() * lambda[i];
            size[it.row()] += std::abs(it.value() * lambda[i]);
        }
    }
    return force.cwiseQuotient(stiffness_).lpNorm<Eigen::Infinity>() <=
           tolerance * std::max(size.cwiseQuotient(stiffness_).lpNorm<Eigen::Infinity>(), underflow);
}

bool Acceptance::rows_are_met(const KktResiduals& kkt, const ConstVectorRef& b, const ConstVectorRef& c,
                              const ConstVectorRef& u, const ConstVectorRef& lambda, double tolerance,
                              double reach) const {
    if (kkt.absolute.penetration == 0 && kkt.complementarity == 0) return true;
    const double moved = this->reach(u), load = b.cwiseQuotient(stiffness_).lpNorm<Eigen::Infinity>();
    // Where A^-1 b is far beyond the answer, its rounding may be all there is.
    const double noise =
        std::min(rounding * std::max({reach, moved, load}), std::max(rounding * load, tolerance * moved));
    double opened = 0, work = b.cwiseProduct(u).lpNorm<1>();
    for (Index i = 0; i < c.size(); ++i) {
        if (c[i] == -infinity) {
            if (lambda[i] != 0) return false;
            continue;
        }
        double gap = -c[i], own = std::max(std::abs(c[i]), underflow);
        for (SparseMatrix::InnerIterator it(Bt_, i); it; ++it) {
            const double term = it.value() * u[it.row()];
            gap += term;
            own += std::abs(term);
        }
        const double allowed = noise * weight_[i];
        const double violation = tolerance * own + allowed;
        if (!(gap >= -violation) || violation == infinity) return false;
        if (lambda[i] == 0) continue;
        opened += lambda[i] * std::max(gap - allowed, 0.0);
        work += lambda[i] * own;
    }
    return opened == 0 || (opened <= 1e-8 * work && kkt.complementarity <= tolerance);
}

bool Acceptance::excludes(const ConstVectorRef& y, const ConstVectorRef& c) const {
    if (!y.allFinite() || !(y.minCoeff() >= 0)) return false;
    Vector force = Vector::Zero(Bt_.rows()), size = force;
    double value = 0, terms = 0, place = 0;
    for (Index i = 0; i < y.size(); ++i) {
        if (y[i] == 0) continue;
        if (weight_[i] > 0) place = std::max(place, std::abs(c[i]) / weight_[i]);
        value += y[i] * c[i];
        terms += y[i] * std::abs(c[i]);
        for (SparseMatrix::InnerIterator it(Bt_, i); it; ++it) {
            force[it.row()] += it.value() * y[i];
            size[it.row()] += std::abs(it.value() * y[i]);
        }
    }
    // Where terms overflow nothing is shown.
    const double largest = size.cwiseQuotient(stiffness_).lpNorm<Eigen::Infinity>();
    if (!(value > 1e-9 * terms) || !std::isfinite(largest)) return false;
    // A u that satisfies the rows has c'y <= (B'y)'u, so its reach is c'y / |B'y|_1 at least: to be far beyond all places that
    // the rows speak of, whatever rounding leaves of B'y.
    const Vector rest = force.cwiseQuotient(stiffness_);
    return rest.lpNorm<Eigen::Infinity>() <= 1e-9 * largest && far * place * rest.lpNorm<1>() <= value;
}

}  // namespace tact
