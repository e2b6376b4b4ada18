#include "tact/rom/training/nnmf.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "tact/rom/training/nndsvd.hpp"

namespace tact {
namespace {

DenseMatrix row_gram(const DenseMatrix& F) {
    DenseMatrix G = DenseMatrix::Zero(F.rows(), F.rows());
    G.selfadjointView<Eigen::Lower>().rankUpdate(F);
    G.triangularView<Eigen::StrictlyUpper>() = G.transpose();
    return G;
}

/// Minimises |T - F'G| over F >= 0, one row of F after the other, `sweeps` times, given P = G T' and S = G G'. Columns
/// of F do not meet, so each goes through all its updates in turn, along with its gradient S f - p; an entry that stays
/// zero costs nothing, and most do.
void update_factor(DenseMatrix& F, const DenseMatrix& P, const DenseMatrix& S, int sweeps) {
    const Index rank = F.rows();
    DenseMatrix gradient = S * F - P;
    for (Index i = 0; i < F.cols(); ++i) {
        double* f = &F(0, i);
        auto g = gradient.col(i);
        for (int sweep = 0; sweep < sweeps; ++sweep)
            for (Index j = 0; j < rank; ++j) {
                if (!(S(j, j) > 0)) continue;  // the other factor's vector is zero: nothing to fit
                const double step = std::max(-g[j] / S(j, j), -f[j]);
                if (step == 0) continue;
                f[j] = std::max(f[j] + step, 0.0);
                g += step * S.col(j);
            }
    }
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
    NonNegativePair factors = nndsvd(X, rank);
    DenseMatrix &W = factors.W_transposed, &H = factors.H_transposed;
    std::vector<double> residuals;
    Outcome outcome = Outcome::iteration_limit;
    DenseMatrix W_gram = row_gram(W);
    for (int sweep = 1; sweep <= options.max_sweeps; ++sweep) {
        update_factor(H, X.transposed_times(W), W_gram, options.inner_sweeps);
        const DenseMatrix H_gram = row_gram(H), X_H = X.times(H);
        update_factor(W, X_H, H_gram, options.inner_sweeps);
        W_gram = row_gram(W);
        // |X - WH'|^2 = |X|^2 - 2 <W, XH> + <W'W, H'H>
        const double square = X.norm() * X.norm() - 2 * W.cwiseProduct(X_H).sum() + W_gram.cwiseProduct(H_gram).sum();
        const double residual = std::sqrt(std::max(square, 0.0)) / X.norm();
        const double previous = residuals.empty() ? infinity : residuals.back();
        residuals.push_back(residual);
        if (options.observer && !options.observer(sweep, residual)) {
            outcome = Outcome::stopped;
            break;
        }
        if (std::isfinite(previous) && previous - residual <= options.tolerance * previous) {
            outcome = Outcome::converged;
            break;
        }
    }
    Nnmf result = expand(X, factors, snapshots.rows(), snapshots.cols());
    result.residuals = std::move(residuals);
    result.outcome = outcome;
    return result;
}

Nnmf nnmf(const DenseMatrix& X, Index rank, const NnmfOptions& options) {
    return nnmf(SparseMatrix(X.sparseView(0, 0)), rank, options);
}

}  // namespace tact
