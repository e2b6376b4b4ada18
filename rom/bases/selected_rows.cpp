#include <Eigen/QR>
#include <algorithm>
#include <numeric>
#include <random>
#include <string>
#include <utility>

#include "dual_basis.hpp"
#include "dual_basis_input.hpp"

namespace tact {
namespace {

/// Rows of B U closer than this fraction of the largest entry of B U are the same to the reduced problem.
constexpr double same_row = 1e-8;

/// Of each group of equal columns of V the first; zero columns are dropped. Ascending.
std::vector<Index> distinct_columns(const DenseMatrix& V) {
    const double near = same_row * V.lpNorm<Eigen::Infinity>();
    // Equal columns have equal sums under any weights; these give others different ones.
    Vector weights(V.rows());
    for (Index i = 0; i < V.rows(); ++i) weights[i] = 1 + 0.618033988749895 * static_cast<double>(i % 89);
    const Vector sums = V.transpose() * weights;
    const double window = near * weights.sum();
    std::vector<Index> order(static_cast<std::size_t>(V.cols()));
    std::iota(order.begin(), order.end(), Index{0});
    std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) { return sums[a] < sums[b]; });
    std::vector<bool> same(order.size(), false);
    for (std::size_t a = 0; a < order.size(); ++a) {
        if (V.col(order[a]).lpNorm<Eigen::Infinity>() <= near) same[static_cast<std::size_t>(order[a])] = true;
        for (std::size_t b = a + 1; b < order.size() && sums[order[b]] - sums[order[a]] <= window; ++b) {
            const Index later = std::max(order[a], order[b]), earlier = std::min(order[a], order[b]);
            if (!same[static_cast<std::size_t>(earlier)] &&
                (V.col(earlier) - V.col(later)).lpNorm<Eigen::Infinity>() <= near)
                same[static_cast<std::size_t>(later)] = true;
        }
    }
    std::vector<Index> distinct;
    for (Index j = 0; j < V.cols(); ++j)
        if (!same[static_cast<std::size_t>(j)]) distinct.push_back(j);
    return distinct;
}

/// The pivots of a QR factorisation of V as far as its rank goes, then evenly spaced ones of the columns left.
std::vector<Index> spread_columns(const DenseMatrix& V, Index size) {
    const Eigen::ColPivHouseholderQR<DenseMatrix> qr(V);
    std::vector<Index> chosen;
    std::vector<bool> taken(static_cast<std::size_t>(V.cols()), false);
    for (Index k = 0; k < std::min(size, qr.rank()); ++k) {
        chosen.push_back(qr.colsPermutation().indices()[k]);
        taken[static_cast<std::size_t>(chosen.back())] = true;
    }
    std::vector<Index> left;
    for (Index j = 0; j < V.cols(); ++j)
        if (!taken[static_cast<std::size_t>(j)]) left.push_back(j);
    const Index fill = std::min(size - static_cast<Index>(chosen.size()), static_cast<Index>(left.size()));
    for (Index k = 0; k < fill; ++k)
        chosen.push_back(left[static_cast<std::size_t>((2 * k + 1) * static_cast<Index>(left.size()) / (2 * fill))]);
    return chosen;
}

/// Exchanges random entries of `rows` and `left` while the error falls; false if progress stopped it.
bool swap_rows(const RowSwaps& swaps, const DualBasisInput& input, std::vector<Index>& rows, std::vector<Index>& left,
               std::vector<double>& errors) {
    if (rows.empty() || left.empty()) return true;
    std::mt19937_64 random(swaps.seed);
    const auto any = [&](std::vector<Index>& of) -> Index& { return of[random() % of.size()]; };
    errors.push_back(swaps.error(input.U, rows));
    for (int k = 0; k < swaps.tries; ++k) {
        if (!report(input, static_cast<double>(k) / swaps.tries)) return false;
        Index& taken = any(rows);
        Index& other = any(left);
        std::swap(taken, other);
        const double error = swaps.error(input.U, rows);
        if (error < errors.back())
            errors.push_back(error);
        else
            std::swap(taken, other);
    }
    return true;
}

}  // namespace

DualBasis selected_rows(RowSwaps swaps) {
    if (swaps.tries < 0)
        throw InputError("RowSwaps: tries is " + std::to_string(swaps.tries) + ", expected at least 0");
    if (swaps.tries > 0 && !swaps.error) throw InputError("RowSwaps: error is empty, expected a function");
    return [swaps = std::move(swaps)](const DualBasisInput& input) {
        const NonNegativeBlock X = checked_snapshots(input);
        DualBasisResult result = empty_dual_basis(input);
        if (input.size < 1 || X.rows() < 1) return result;
        const std::vector<Index>& touched = X.row_places();
        const DenseMatrix seen = input.B.times(input.U)(touched, Eigen::all).transpose();
        const std::vector<Index> distinct = distinct_columns(seen);
        if (distinct.empty()) return result;
        std::vector<Index> rows, left;
        for (const Index j : distinct) left.push_back(touched[static_cast<std::size_t>(j)]);
        for (const Index k : spread_columns(seen(Eigen::all, distinct), input.size))
            rows.push_back(left[static_cast<std::size_t>(k)]);
        if (swaps.tries > 0) {
            std::erase_if(left, [&](Index row) { return std::ranges::find(rows, row) != rows.end(); });
            if (!swap_rows(swaps, input, rows, left, result.residuals)) result.outcome = Outcome::stopped;
        }
        result.U_lambda = unit_vectors(input.snapshots.rows(), rows);
        return result;
    };
}

}  // namespace tact
