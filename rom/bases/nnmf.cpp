#include "nnmf.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "nndsvd.hpp"

namespace tact {
namespace {

DenseMatrix row_gram(const DenseMatrix& F) {
    DenseMatrix G = DenseMatrix::Zero(F.rows(), F.rows());
    G.selfadjointView<Eigen::Lower>().rankUpdate(F);
    G.triangularView<Eigen::StrictlyUpper>() = G.transpose();
    return G;
}

/// Numbers in (0, 1).
NonNegativePair random_start(const NonNegativeBlock& X, Index rank, std::uint64_t seed) {
    std::uint64_t state = seed;
    const auto fill = [&](Index columns) {
        DenseMatrix F(rank, columns);
        for (double& value : F.reshaped()) {
            // splitmix64: any seed will do, zero included.
            std::uint64_t z = state += 0x9e3779b97f4a7c15;
            z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
            z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
            value = (static_cast<double>((z ^ (z >> 31)) >> 12) + 0.5) * 0x1p-52;
        }
        return F;
    };
    DenseMatrix W = fill(X.rows());
    return {std::move(W), fill(X.cols())};
}

void fill_zeros(DenseMatrix& F) {
    const double small = F.mean() / 100;
    F = (F.array() > 0).select(F, small);
}

NonNegativePair start_of(const NonNegativeBlock& X, Index rank, const NnmfOptions& options, int attempt) {
    if (options.random) return random_start(X, rank, options.random->seed + static_cast<std::uint64_t>(attempt));
    NonNegativePair start = nndsvd(X, rank);
    if (options.updates == NnmfUpdates::multiplicative) {
        fill_zeros(start.W_transposed);
        fill_zeros(start.H_transposed);
    }
    return start;
}

/// Where a factorisation ended, on the non-zero rows and columns.
struct Factorised {
    NonNegativePair factors;
    std::vector<double> residuals;
    Outcome outcome = Outcome::iteration_limit;
};

Factorised factorize(const NonNegativeBlock& X, NonNegativePair start, const NnmfOptions& options) {
    Factorised result{std::move(start), {}, Outcome::iteration_limit};
    DenseMatrix &W = result.factors.W_transposed, &H = result.factors.H_transposed;
    DenseMatrix W_gram = row_gram(W);
    for (int sweep = 1; sweep <= options.max_sweeps; ++sweep) {
        update_factor(options.updates, H, X.transposed_times(W), W_gram, options.inner_sweeps);
        const DenseMatrix H_gram = row_gram(H), X_H = X.times(H);
        update_factor(options.updates, W, X_H, H_gram, options.inner_sweeps);
        W_gram = row_gram(W);
        // |X - WH'|^2 = |X|^2 - 2 <W, XH> + <W'W, H'H>
        const double square = X.norm() * X.norm() - 2 * W.cwiseProduct(X_H).sum() + W_gram.cwiseProduct(H_gram).sum();
        const double residual = std::sqrt(std::max(square, 0.0)) / X.norm();
        const double previous = result.residuals.empty() ? infinity : result.residuals.back();
        result.residuals.push_back(residual);
        if (options.observer && !options.observer(sweep, residual)) {
            result.outcome = Outcome::stopped;
            break;
        }
        if (std::isfinite(previous) && previous - residual <= options.tolerance * previous) {
            result.outcome = Outcome::converged;
            break;
        }
    }
    return result;
}

/// Puts the factors in their places, vectors of U_lambda at unit length, those that are zero left out.
Nnmf expand(const NonNegativeBlock& X, const NonNegativePair& factors, Index m, Index N) {
    std::vector<Index> used;
    for (Index j = 0; j < factors.W_transposed.rows(); ++j)
        if (factors.W_transposed.row(j).norm() > 0 && factors.H_transposed.row(j).norm() > 0) used.push_back(j);
    Nnmf result;
    result.U_lambda.setZero(m, static_cast<Index>(used.size()));
    result.V.setZero(static_cast<Index>(used.size()), N);
    const auto &rows = X.row_places(), &columns = X.column_places();
    for (std::size_t k = 0; k < used.size(); ++k) {
        const auto w = factors.W_transposed.row(used[k]), h = factors.H_transposed.row(used[k]);
        const double length = w.norm();
        const auto r = static_cast<Index>(k);
        for (std::size_t i = 0; i < rows.size(); ++i) result.U_lambda(rows[i], r) = w[static_cast<Index>(i)] / length;
        for (std::size_t j = 0; j < columns.size(); ++j) result.V(r, columns[j]) = h[static_cast<Index>(j)] * length;
    }
    return result;
}

}  // namespace

Nnmf nnmf(const SparseMatrix& snapshots, Index rank, const NnmfOptions& options) {
    const NonNegativeBlock X(snapshots);
    if (rank < 1 || rank > X.cols())
        throw InputError("nnmf: rank is " + std::to_string(rank) +
                         ", expected 1 to the number of non-zero snapshots, " + std::to_string(X.cols()));
    const int attempts = options.random ? options.random->count : 1;
    if (attempts < 1) throw InputError("nnmf: random.count is " + std::to_string(attempts) + ", expected at least 1");
    Factorised best;
    for (int attempt = 0; attempt < attempts && best.outcome != Outcome::stopped; ++attempt) {
        Factorised reached = factorize(X, start_of(X, rank, options, attempt), options);
        const bool lower = best.residuals.empty() ||
                           (!reached.residuals.empty() && reached.residuals.back() < best.residuals.back());
        if (reached.outcome == Outcome::stopped) best.outcome = Outcome::stopped;
        if (lower) best = std::move(reached);
    }
    Nnmf result = expand(X, best.factors, snapshots.rows(), snapshots.cols());
    result.residuals = std::move(best.residuals);
    result.outcome = best.outcome;
    return result;
}

Nnmf nnmf(const DenseMatrix& X, Index rank, const NnmfOptions& options) {
    return nnmf(SparseMatrix(X.sparseView(0, 0)), rank, options);
}

}  // namespace tact
