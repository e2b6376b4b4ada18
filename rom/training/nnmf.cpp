#include "tact/rom/training/nnmf.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "tact/rom/training/gram.hpp"
#include "tact/rom/training/nndsvd.hpp"

namespace tact {
namespace {

/// The non-zero rows and columns of X as a dense block, and where they lie.
struct Compact {
    DenseMatrix block;
    std::vector<Index> rows, columns;
};

[[noreturn]] void reject_entry(double value, Index i, Index j) {
    throw InputError("nnmf: X(" + std::to_string(i) + "," + std::to_string(j) + ") is " + std::to_string(value) +
                     ", expected a finite number >= 0");
}

Compact compact(const SparseMatrix& X) {
    Compact result;
    std::vector<Index> position(static_cast<std::size_t>(X.rows()), -1);
    for (Index j = 0; j < X.cols(); ++j) {
        bool used = false;
        for (SparseMatrix::InnerIterator it(X, j); it; ++it) {
            if (!(it.value() >= 0) || !std::isfinite(it.value())) reject_entry(it.value(), it.row(), j);
            if (it.value() == 0) continue;
            used = true;
            position[static_cast<std::size_t>(it.row())] = 0;
        }
        if (used) result.columns.push_back(j);
    }
    for (std::size_t i = 0; i < position.size(); ++i) {
        if (position[i] < 0) continue;
        position[i] = static_cast<Index>(result.rows.size());
        result.rows.push_back(static_cast<Index>(i));
    }
    result.block.setZero(static_cast<Index>(result.rows.size()), static_cast<Index>(result.columns.size()));
    for (Index j = 0; j < result.block.cols(); ++j)
        for (SparseMatrix::InnerIterator it(X, result.columns[static_cast<std::size_t>(j)]); it; ++it)
            if (it.value() != 0) result.block(position[static_cast<std::size_t>(it.row())], j) = it.value();
    return result;
}

/// Minimises |T - F G'| over F >= 0 column by column, `sweeps` times, given P = T G and S = G'G. Rows of F do not
/// meet, so a panel of rows goes through all its updates while it is in cache.
void update_factor(DenseMatrix& F, const DenseMatrix& P, const DenseMatrix& S, int sweeps) {
    constexpr Index panel_rows = 64;
    DenseMatrix panel(panel_rows, F.cols());
    Vector product(panel_rows);
    for (Index i = 0; i < F.rows(); i += panel_rows) {
        const Index rows = std::min(panel_rows, F.rows() - i);
        auto f = panel.topRows(rows);
        auto step = product.head(rows);
        f = F.middleRows(i, rows);
        for (int sweep = 0; sweep < sweeps; ++sweep)
            for (Index j = 0; j < F.cols(); ++j) {
                if (!(S(j, j) > 0)) continue;  // the other factor's column is zero: nothing to fit
                step.noalias() = f * S.col(j);
                f.col(j) = (f.col(j) + (P.block(i, j, rows, 1) - step) / S(j, j)).cwiseMax(0);
            }
        F.middleRows(i, rows) = f;
    }
}

/// Gives both columns of each pair the same length, so that neither factor drifts out of range.
void balance(DenseMatrix& W, DenseMatrix& H) {
    for (Index j = 0; j < W.cols(); ++j) {
        const double w = W.col(j).norm(), h = H.col(j).norm();
        if (!(w > 0) || !(h > 0)) {
            W.col(j).setZero();
            H.col(j).setZero();
            continue;
        }
        W.col(j) *= std::sqrt(h / w);
        H.col(j) *= std::sqrt(w / h);
    }
}

Nnmf expand(const Compact& X, const NonNegativePair& factors, Index m, Index N) {
    std::vector<Index> used;
    for (Index j = 0; j < factors.W.cols(); ++j)
        if (factors.W.col(j).norm() > 0) used.push_back(j);
    Nnmf result;
    result.U_lambda.setZero(m, static_cast<Index>(used.size()));
    result.V.setZero(static_cast<Index>(used.size()), N);
    for (std::size_t k = 0; k < used.size(); ++k) {
        const auto w = factors.W.col(used[k]), h = factors.H.col(used[k]);
        const double length = w.norm();
        const Index r = static_cast<Index>(k);
        for (std::size_t i = 0; i < X.rows.size(); ++i)
            result.U_lambda(X.rows[i], r) = w[static_cast<Index>(i)] / length;
        for (std::size_t j = 0; j < X.columns.size(); ++j)
            result.V(r, X.columns[j]) = h[static_cast<Index>(j)] * length;
    }
    return result;
}

}  // namespace

Nnmf nnmf(const SparseMatrix& sparse, Index rank, const NnmfOptions& options) {
    const Compact compacted = compact(sparse);
    const DenseMatrix& X = compacted.block;
    if (rank < 1 || rank > X.cols())
        throw InputError("nnmf: rank is " + std::to_string(rank) +
                         ", expected 1 to the number of non-zero snapshots, " + std::to_string(X.cols()));
    auto [W, H] = nndsvd(X, rank);
    const double norm = X.norm();
    std::vector<double> residuals;
    Outcome outcome = Outcome::iteration_limit;
    DenseMatrix product;
    DenseMatrix W_gram = gram(W);
    for (int sweep = 1; sweep <= options.max_sweeps; ++sweep) {
        product.noalias() = X.transpose() * W;
        update_factor(H, product, W_gram, options.inner_sweeps);
        const DenseMatrix H_gram = gram(H);
        product.noalias() = X * H;
        update_factor(W, product, H_gram, options.inner_sweeps);
        W_gram = gram(W);
        // |X - WH'|^2 = |X|^2 - 2 <W, XH> + <W'W, H'H>
        const double square = norm * norm - 2 * W.cwiseProduct(product).sum() + W_gram.cwiseProduct(H_gram).sum();
        const double residual = std::sqrt(std::max(square, 0.0)) / norm;
        const double previous = residuals.empty() ? infinity : residuals.back();
        residuals.push_back(residual);
        if (options.observer && !options.observer(sweep, residual)) {
            outcome = Outcome::stopped;
            break;
        }
        if (previous - residual <= options.tolerance * previous && std::isfinite(previous)) {
            outcome = Outcome::converged;
            break;
        }
    }
    balance(W, H);
    Nnmf result = expand(compacted, {std::move(W), std::move(H)}, sparse.rows(), sparse.cols());
    result.residuals = std::move(residuals);
    result.outcome = outcome;
    return result;
}

Nnmf nnmf(const DenseMatrix& X, Index rank, const NnmfOptions& options) {
    for (Index j = 0; j < X.cols(); ++j)
        for (Index i = 0; i < X.rows(); ++i)
            if (!(X(i, j) >= 0) || !std::isfinite(X(i, j))) reject_entry(X(i, j), i, j);
    return nnmf(SparseMatrix(X.sparseView(0, 0)), rank, options);
}

}  // namespace tact
