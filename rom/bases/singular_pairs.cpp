#include "singular_pairs.hpp"

#include <algorithm>
#include <cstdint>

#include "../model/orthonormal.hpp"
#include "gram.hpp"

namespace tact {
namespace {

constexpr Index exact_size = 400;    // a Gram matrix up to this size is decomposed outright
constexpr Index oversampling = 12;   // columns beside those wanted
constexpr int power_iterations = 3;  // separates singular values 2 % apart over `oversampling` columns well enough

/// Numbers in (-1, 1) that are the same on every machine.
DenseMatrix fixed_start(Index rows, Index cols) {
    std::uint64_t state = 0x9e3779b97f4a7c15;
    DenseMatrix X(rows, cols);
    for (Index j = 0; j < cols; ++j)
        for (Index i = 0; i < rows; ++i) {
            state = state * 6364136223846793005u + 1442695040888963407u;
            X(i, j) = static_cast<double>(state >> 11) * 0x1p-52 - 1;
        }
    return X;
}

}  // namespace

SingularPairs leading_singular_pairs(const NonNegativeBlock& X, Index rank) {
    if (X.cols() <= exact_size) {
        const DenseMatrix dense = X.dense();
        DenseMatrix V = gram_eigen(gram(dense)).vectors.leftCols(std::min(rank, X.cols()));
        return {dense * V, std::move(V)};
    }
    const auto image = [&](const DenseMatrix& Y) -> DenseMatrix { return X.times(Y.transpose()).transpose(); };
    const auto coimage = [&](const DenseMatrix& Y) -> DenseMatrix {
        return X.transposed_times(Y.transpose()).transpose();
    };
    DenseMatrix Q;
    if (X.rows() <= exact_size) {
        Q = gram_eigen(gram(X.dense().transpose())).vectors.leftCols(std::min(rank, X.rows()));
    } else {
        Q = image(fixed_start(X.cols(), std::min(rank + oversampling, std::min(X.rows(), X.cols()))));
        for (int k = 0; k < power_iterations; ++k)
            Q = image(orthonormal_columns(coimage(orthonormal_columns(std::move(Q)))));
        Q = orthonormal_columns(std::move(Q));
    }
    // X ~ Q Q'X: the singular vectors of the small factor's Gram matrix finish the job.
    const DenseMatrix projected = coimage(Q);
    const GramEigen small = gram_eigen(gram(projected));
    const Index r = std::min(rank, Q.cols());
    DenseMatrix V = projected * small.vectors.leftCols(r);
    for (Index j = 0; j < r; ++j)
        if (small.singular_values[j] > 0) V.col(j) /= small.singular_values[j];
    return {Q * small.vectors.leftCols(r) * small.singular_values.head(r).asDiagonal(), std::move(V)};
}

}  // namespace tact
