#include "../../../lib/sparse/numbering.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "../../../lib/sparse/aggregation.hpp"
#include "random_matrices.hpp"

namespace tact {
namespace {

using Permutation = Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, long>;

SparseMatrix shuffled(const SparseMatrix& A) {
    std::mt19937 random(5);
    Permutation P(A.rows());
    P.setIdentity();
    std::shuffle(P.indices().data(), P.indices().data() + A.rows(), random);
    SparseMatrix result;
    result = A.twistedBy(P);
    return result;
}

TEST(Numbering, WavesPutARandomNumberingBackIntoLines) {
    const SparseMatrix A = shuffled(test::laplacian(40));
    auto order = wave_order(A).order;
    const Matrix P = renumbered(A, order);
    const auto colours = greedy_colours(compressed_columns(*P.sparse()));
    EXPECT_EQ(*std::max_element(colours.begin(), colours.end()), 1);
    EXPECT_TRUE(wave_order(*P.sparse()).order.empty());
    std::sort(order.begin(), order.end());
    for (int i = 0; i < A.rows(); ++i) ASSERT_EQ(order[static_cast<std::size_t>(i)], i);
}

TEST(Numbering, WhatReadsWellStays) {
    EXPECT_TRUE(wave_order(test::laplacian(40)).order.empty());
    SparseMatrix holes = test::laplacian(40);  // no two columns alike, but near the diagonal
    holes.prune([](long i, long j, double) { return i == j || (i * j) % 3 != 0; });
    EXPECT_TRUE(wave_order(holes).order.empty());
    EXPECT_TRUE(wave_order(SparseMatrix(0, 0)).order.empty());
}

TEST(Numbering, RenumberedIsWhatEigensPermutationMakes) {
    SparseMatrix A = shuffled(test::laplacian(9));
    for (const bool symmetric : {true, false}) {
        if (!symmetric)
            for (long k = 0; k < A.nonZeros(); ++k) A.valuePtr()[k] = 0.1 * static_cast<double>(k);
        std::vector<int> order(static_cast<std::size_t>(A.rows()));
        for (int i = 0; i < A.rows(); ++i) order[static_cast<std::size_t>(i)] = 7 * i % 81;
        order.back() = std::exchange(order[3], order.back());
        Permutation P(A.rows());
        for (int i = 0; i < A.rows(); ++i) P.indices()[order[static_cast<std::size_t>(i)]] = i;
        SparseMatrix expected;
        expected = A.twistedBy(P);
        EXPECT_EQ(renumbered(A, order).to_dense(), DenseMatrix(expected));
    }
}

}  // namespace
}  // namespace tact
