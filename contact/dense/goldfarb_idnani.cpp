#include "goldfarb_idnani.hpp"

#include <algorithm>
#include <cmath>

namespace tact {

/// Leaves C and multiplier_ with S(C,C) multiplier_ = g_C, multiplier_ >= 0: any such pair is a valid start.
void GoldfarbIdnani::start_from(const DenseMatrix& S, const ConstVectorRef& g, const ConstVectorRef& lambda) {
    for (Index i = factor_.size() - 1; i >= 0; --i)
        if (!(lambda[factor_.rows()[static_cast<std::size_t>(i)]] > 0)) factor_.remove(i);
    const Index wanted = (lambda.array() > 0).count();
    if (wanted != factor_.size()) {
        const auto& rows = factor_.rows();
        for (Index i = 0; i < lambda.size(); ++i)
            if (lambda[i] > 0 && std::find(rows.begin(), rows.end(), i) == rows.end()) factor_.append(S, i);
    }
    while (factor_.size() > 0) {
        const Index k = factor_.size();
        for (Index i = 0; i < k; ++i) multiplier_[i] = g[factor_.rows()[static_cast<std::size_t>(i)]];
        factor_.solve(multiplier_.head(k));
        Index negative = 0;
        Index worst = 0;
        for (Index i = 0; i < k; ++i) {
            if (multiplier_[i] < 0) ++negative;
            if (multiplier_[i] < multiplier_[worst]) worst = i;
        }
        if (negative == 0) return;
        if (negative <= 4) {
            factor_.remove(worst);
        } else {
            for (Index i = k - 1; i >= 0; --i)
                if (multiplier_[i] < 0) factor_.remove(i);
        }
    }
}

/// y = e_q - r on the rows in the factor: S y = 0. Whether g'y > 0 beyond rounding, so that no u satisfies the rows.
bool GoldfarbIdnani::excludes(const ConstVectorRef& g, Index q) {
    certificate_ = Vector::Zero(g.size());
    certificate_[q] = 1;
    for (Index i = 0; i < factor_.size(); ++i)
        certificate_[factor_.rows()[static_cast<std::size_t>(i)]] = std::max(-r_[i], 0.0);
    double value = 0, size = 0;
    for (Index i = 0; i < g.size(); ++i)
        if (certificate_[i] > 0) {
            value += certificate_[i] * g[i];
            size += certificate_[i] * std::abs(g[i]);
        }
    return value > 1e-9 * size;
}

void GoldfarbIdnani::gaps(const DenseMatrix& S, const ConstVectorRef& g, VectorRef w) const {
    w = -g;
    for (Index i = 0; i < factor_.size(); ++i)
        w += multiplier_[i] * S.col(factor_.rows()[static_cast<std::size_t>(i)]).head(g.size());
}

void GoldfarbIdnani::reserve(Index m) {
    for (Vector* v : {&multiplier_, &l_, &r_}) v->resize(m + 1);
    factor_.reserve(m + 1);
    forgiven_.reserve(static_cast<std::size_t>(m));
}

GoldfarbIdnani::Report GoldfarbIdnani::solve(const DenseMatrix& S, const ConstVectorRef& g,
                                             const ConstVectorRef& allowance, VectorRef lambda, VectorRef w) {
    const Index m = g.size();
    if (multiplier_.size() < m + 1)
        for (Vector* v : {&multiplier_, &l_, &r_}) v->resize(m + 1);
    Report report;
    forgiven_.clear();
    start_from(S, g, lambda);
    gaps(S, g, w);
    // Each step raises the dual objective; what needs more is so ill conditioned that S has lost its meaning.
    const int limit = static_cast<int>(std::min<Index>(2 * m + 200, 10000000));
    while (true) {
        // The most violated row, each measured in its own energy norm.
        Index q = -1;
        double worst = 0;
        // What the sum S lambda itself rounds to, in energy units.
        double noise = 0;
        for (Index i = 0; i < factor_.size(); ++i) {
            const Index row = factor_.rows()[static_cast<std::size_t>(i)];
            noise += 4e-16 * multiplier_[i] * std::sqrt(S(row, row));
        }
        for (Index i = 0; i < m; ++i) {
            if (!(w[i] < -allowance[i])) continue;
            const double unit = std::sqrt(S(i, i));
            const double violation = unit > 0 ? w[i] / unit : -infinity;
            if (violation < worst && violation < -noise &&
                std::find(forgiven_.begin(), forgiven_.end(), i) == forgiven_.end()) {
                const auto& rows = factor_.rows();
                if (std::find(rows.begin(), rows.end(), i) != rows.end()) continue;  // rounding on an active row
                worst = violation;
                q = i;
            }
        }
        if (q < 0) break;

        double multiplier_q = 0, gap_q = w[q];
        while (true) {
            if (++report.iterations > limit) {
                report.outcome = Outcome::iteration_limit;
                return report;
            }
            const Index k = factor_.size();
            const double pivot = factor_.pivot(S, q, l_.head(k));
            r_.head(k) = l_.head(k);
            factor_.solve_upper(r_.head(k));
            const bool dependent = !(pivot > SchurFactor::dependence * S(q, q));
            const double full_step = dependent ? infinity : -gap_q / pivot;
            double partial_step = infinity;
            Index leaving = -1;
            // Below this an entry of r is rounding, not a direction in which a multiplier falls.
            const double falling = k > 0 ? 1e-12 * r_.head(k).cwiseAbs().maxCoeff() : 0;
            for (Index i = 0; i < k; ++i) {
                if (!(r_[i] > falling)) continue;
                const double step = multiplier_[i] / r_[i];
                if (step < partial_step) {
                    partial_step = step;
                    leaving = i;
                }
            }
            const double step = std::min(full_step, partial_step);
            if (step == infinity) {
                if (excludes(g, q)) {
                    report.outcome = Outcome::infeasible;
                    return report;
                }
                if (-w[q] > forgivable * allowance[q]) {
                    report.outcome = Outcome::inaccurate;
                    return report;
                }
                // Dependent, and violated by rounding only: the others hold it. Back to a valid pair without it.
                forgiven_.push_back(q);
                lambda.setZero();
                for (Index i = 0; i < k; ++i)
                    if (multiplier_[i] > 0) lambda[factor_.rows()[static_cast<std::size_t>(i)]] = multiplier_[i];
                start_from(S, g, lambda);
                break;
            }
            multiplier_.head(k) -= step * r_.head(k);
            multiplier_q += step;
            if (!dependent) gap_q += step * pivot;
            if (full_step <= partial_step) {
                factor_.append(q, l_.head(k), pivot);
                multiplier_[k] = multiplier_q;
                break;
            }
            std::copy(multiplier_.data() + leaving + 1, multiplier_.data() + k, multiplier_.data() + leaving);
            factor_.remove(leaving);
        }
        gaps(S, g, w);
    }
    if (report.iterations > 0) {
        // The steps added up; one clean solve on the final set ends at the rounding floor.
        const Index k = factor_.size();
        for (Index i = 0; i < k; ++i) multiplier_[i] = g[factor_.rows()[static_cast<std::size_t>(i)]];
        factor_.solve(multiplier_.head(k));
    }
    lambda.setZero();
    for (Index i = 0; i < factor_.size(); ++i)
        lambda[factor_.rows()[static_cast<std::size_t>(i)]] = std::max(multiplier_[i], 0.0);
    return report;
}

}  // namespace tact
