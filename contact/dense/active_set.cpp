#include "tact/contact/dense/active_set.hpp"

#include <algorithm>
#include <cmath>

namespace tact {
namespace {

/// A fingerprint of a set, independent of its order.
std::uint64_t fingerprint(const std::vector<Index>& rows) {
    std::uint64_t sum = 0;
    for (const Index row : rows) {
        auto x = static_cast<std::uint64_t>(row) + 0x9e3779b97f4a7c15ULL;
        x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
        x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
        sum += x ^ (x >> 31);
    }
    return sum;
}

}  // namespace

CondensedActiveSet::Report CondensedActiveSet::solve(const DenseMatrix& S, const ConstVectorRef& g,
                                                     const ConstVectorRef& allowance, VectorRef lambda, VectorRef w) {
    const Index m = g.size();
    if (multiplier_.size() < m) multiplier_.resize(m);
    Report report;
    wanted_.clear();
    for (Index i = 0; i < m; ++i)
        if (lambda[i] > 0) wanted_.push_back(i);
    if (wanted_.empty()) {
        // From no contact the first set would be every violated row, hundreds where tens stay: rows one by one are
        // cheaper.
        exact_.reset();
        const auto end = exact_.solve(S, g, allowance, lambda, w);
        report.iterations = end.iterations;
        report.outcome = end.outcome;
        return report;
    }
    visited_.clear();
    constexpr int limit = 60;
    while (true) {
        const auto print = fingerprint(wanted_);
        const bool seen = std::find(visited_.begin(), visited_.end(), print) != visited_.end();
        if (seen || ++report.iterations > limit) {
            report.repeated = seen;
            lambda.setZero();
            exact_.reset();
            const auto end = exact_.solve(S, g, allowance, lambda, w);
            report.iterations += end.iterations;
            report.outcome = end.outcome;
            return report;
        }
        visited_.push_back(print);
        factor_.rebuild(S, wanted_);
        const Index k = factor_.size();
        const auto& rows = factor_.rows();
        for (Index i = 0; i < k; ++i) multiplier_[i] = g[rows[static_cast<std::size_t>(i)]];
        factor_.solve(multiplier_.head(k));
        w = -g;
        for (Index i = 0; i < k; ++i) w += multiplier_[i] * S.col(rows[static_cast<std::size_t>(i)]).head(m);
        bool settled = true;
        lambda.setZero();
        for (Index i = 0; i < k; ++i) {
            const Index row = rows[static_cast<std::size_t>(i)];
            w[row] = 0;
            if (multiplier_[i] > 0)
                lambda[row] = multiplier_[i];
            else
                settled = false;
        }
        // What the sum S lambda itself rounds to, in energy units.
        double noise = 0;
        for (const Index row : rows) noise += 4e-16 * lambda[row] * std::sqrt(S(row, row));
        wanted_.clear();
        for (Index i = 0; i < m; ++i) {
            if (lambda[i] > 0) {
                wanted_.push_back(i);
            } else if (w[i] < -allowance[i] - noise * std::sqrt(S(i, i))) {
                wanted_.push_back(i);
                settled = false;
            }
        }
        // Dependent rows left out of the factor are held by the others; where they are not, they count as violated.
        if (settled) return report;
    }
}

}  // namespace tact
