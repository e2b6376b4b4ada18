#include "unsymmetric_active_set.hpp"

#include <algorithm>
#include <cmath>

namespace tact {

/// In units of energy, where the condition says whether the rows are dependent.
bool UnsymmetricActiveSet::factor(const DenseMatrix& S) {
    if (rows_ == wanted_) return true;
    rows_ = wanted_;
    const Index k = static_cast<Index>(rows_.size());
    if (k == 0) return true;
    DenseMatrix block = S(rows_, rows_);
    const Vector unit = block.diagonal().unaryExpr([](double s) { return s > 0 ? 1 / std::sqrt(s) : 1.0; });
    block = unit.asDiagonal() * block * unit.asDiagonal();
    lu_.compute(block);
    if (lu_.rcond() > 1e-14) return true;
    rows_.clear();
    return false;
}

CondensedActiveSet::Report UnsymmetricActiveSet::solve(const DenseMatrix& S, const ConstVectorRef& g,
                                                       const ConstVectorRef& allowance, VectorRef lambda,
                                                       VectorRef w) {
    const Index m = g.size();
    CondensedActiveSet::Report report;
    exchanges_.start();
    active_.resize(static_cast<std::size_t>(m));
    for (Index i = 0; i < m; ++i) active_[static_cast<std::size_t>(i)] = lambda[i] > 0;
    // Of the terms of g_i: rounding leaves that much of a gap or of what a multiplier opens, more where a set comes back.
    double noise = 4e-16;
    const int limit = 200 + 2 * static_cast<int>(m);
    for (report.iterations = 1; report.iterations <= limit; ++report.iterations) {
        wanted_.clear();
        for (Index i = 0; i < m; ++i)
            if (active_[static_cast<std::size_t>(i)]) wanted_.push_back(i);
        if (!factor(S)) {
            report.outcome = Outcome::inaccurate;
            return report;
        }
        const Index k = static_cast<Index>(rows_.size());
        lambda.setZero();
        w = -g;
        double reached = 0;  // in energy units
        if (k > 0) {
            right_.resize(k);
            for (Index j = 0; j < k; ++j) {
                const Index row = rows_[static_cast<std::size_t>(j)];
                right_[j] = g[row] / std::sqrt(S(row, row));
            }
            right_ = lu_.solve(right_).eval();
            for (Index j = 0; j < k; ++j) {
                const Index row = rows_[static_cast<std::size_t>(j)];
                lambda[row] = right_[j] / std::sqrt(S(row, row));
                reached += std::abs(right_[j]);
                w += lambda[row] * S.col(row).head(m);
            }
        }
        wrong_.clear();
        for (Index i = 0; i < m; ++i) {
            const double unit = std::sqrt(S(i, i));
            if (active_[static_cast<std::size_t>(i)]) {
                w[i] = 0;
                if (!(lambda[i] * unit >= -noise * reached)) wrong_.push_back(i);
            } else if (w[i] < -allowance[i] - noise * reached * unit) {
                wrong_.push_back(i);
            }
        }
        if (wrong_.empty()) {
            lambda = lambda.cwiseMax(0);
            return report;
        }
        if (!exchanges_.apply(active_, wrong_)) {
            report.repeated = true;
            noise = std::min(16 * noise, 1e-12);
        }
    }
    report.outcome = Outcome::cycling;
    return report;
}

}  // namespace tact
