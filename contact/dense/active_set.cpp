#include "active_set.hpp"

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
    for (std::size_t k = 0; k < wanted_.size(); ++k) multiplier_[static_cast<Index>(k)] = lambda[wanted_[k]];
    // Rows that join a settled problem leave its multipliers right: what they press on is known without a factor.
    if (balances(S, g, wanted_, w) && update(S, allowance, wanted_, lambda, w)) return report;
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
        const bool changed = factor_.change(S, wanted_);
        if (!solve_equations(S, g, w) && changed) {
            // Many changes leave their rounding in the factor.
            factor_.rebuild(S, wanted_);
            (void)solve_equations(S, g, w);
        }
        // Dependent rows left out of the factor are held by the others; where they are not, they count as violated.
        if (update(S, allowance, factor_.rows(), lambda, w)) return report;
    }
}

bool CondensedActiveSet::solve_equations(const DenseMatrix& S, const ConstVectorRef& g, VectorRef w) {
    const auto& rows = factor_.rows();
    for (std::size_t k = 0; k < rows.size(); ++k) multiplier_[static_cast<Index>(k)] = g[rows[k]];
    factor_.solve(multiplier_.head(factor_.size()));
    return balances(S, g, rows, w);
}

bool CondensedActiveSet::balances(const DenseMatrix& S, const ConstVectorRef& g, const std::vector<Index>& rows,
                                  VectorRef w) {
    w = -g;
    noise_ = 0;
    for (std::size_t k = 0; k < rows.size(); ++k) {
        const double multiplier = multiplier_[static_cast<Index>(k)];
        w += multiplier * S.col(rows[k]).head(g.size());
        noise_ += 4e-16 * std::abs(multiplier) * std::sqrt(S(rows[k], rows[k]));
    }
    return std::all_of(rows.begin(), rows.end(),
                       [&](Index row) { return std::abs(w[row]) <= 4 * noise_ * std::sqrt(S(row, row)); });
}

bool CondensedActiveSet::update(const DenseMatrix& S, const ConstVectorRef& allowance, const std::vector<Index>& rows,
                                VectorRef lambda, VectorRef w) {
    bool settled = true;
    lambda.setZero();
    for (std::size_t k = 0; k < rows.size(); ++k) {
        const double multiplier = multiplier_[static_cast<Index>(k)];
        w[rows[k]] = 0;
        if (multiplier > 0)
            lambda[rows[k]] = multiplier;
        else
            settled = false;
    }
    wanted_.clear();
    for (Index i = 0; i < lambda.size(); ++i) {
        if (lambda[i] > 0) {
            wanted_.push_back(i);
        } else if (w[i] < -allowance[i] - noise_ * std::sqrt(S(i, i))) {
            wanted_.push_back(i);
            settled = false;
        }
    }
    return settled;
}

}  // namespace tact
