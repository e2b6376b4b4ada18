#include "../../../lib/sparse/band_factor.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <random>

#include "../../../lib/errors.hpp"
#include "random_matrices.hpp"

namespace tact {
namespace {

/// C'C + shift for a random lower band C.
SparseMatrix random_band(Index n, Index width, double shift, unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    DenseMatrix C = DenseMatrix::Zero(n, n);
    for (Index j = 0; j < n; ++j)
        for (Index i = j; i <= std::min(j + width, n - 1); ++i) C(i, j) = normal(random);
    const DenseMatrix A = C * C.transpose() + shift * DenseMatrix::Identity(n, n);
    return A.sparseView();
}

TEST(BandFactor, AgreesWithDenseCholeskyAndIsBackwardStable) {
    for (Index width = 1; width <= BandFactor::widest; ++width)
        for (Index n = 4 * width; n <= 60; ++n) {
            const SparseMatrix A = random_band(n, width, 0.5, static_cast<unsigned>(n));
            ASSERT_EQ(BandFactor::half_width(A), width);
            const BandFactor factor(A, "A");
            const DenseMatrix B = test::random_columns(n, 3, static_cast<unsigned>(n));
            DenseMatrix X = B;
            for (Index j = 0; j < 3; ++j) factor.solve(X.col(j).data());
            EXPECT_LT((X - DenseMatrix(A).llt().solve(B)).norm(), 1e-11 * X.norm()) << n << " rows, width " << width;
            EXPECT_LT(test::backward_error(A, X, B), 2e-15) << n << " rows, width " << width;
        }
}

TEST(BandFactor, StaysBackwardStableWhenTheConditionIsBad) {
    for (const double shift : {1e-6, 1e-9, 1e-11})
        for (Index width = 1; width <= BandFactor::widest; ++width) {
            const SparseMatrix A = random_band(500, width, shift, 3);
            const BandFactor factor(A, "A");
            for (const DenseMatrix& B :
                 {DenseMatrix(test::random_columns(500, 1, 1)), DenseMatrix(A * test::random_columns(500, 1, 2))}) {
                DenseMatrix X = B;
                factor.solve(X.data());
                EXPECT_LT(test::backward_error(A, X, B), 4e-15) << "shift " << shift << ", width " << width;
            }
        }
}

TEST(BandFactor, ItsWidthIsThatOfTheMatrixOrAllOfIt) {
    EXPECT_EQ(BandFactor::half_width(random_band(40, 5, 1, 1)), 40);
    EXPECT_EQ(BandFactor::half_width(random_band(15, 4, 1, 1)), 15);
    SparseMatrix corner = random_band(40, 1, 1, 1);
    corner.coeffRef(39, 0) = corner.coeffRef(0, 39) = 0.1;
    EXPECT_EQ(BandFactor::half_width(corner), 40);
}

TEST(BandFactor, AFloatingChainAndAnIndefiniteOneAreNamed) {
    DenseMatrix A = DenseMatrix::Zero(20, 20);
    for (Index i = 0; i + 1 < 20; ++i) {
        A(i, i) += 1;
        A(i + 1, i + 1) += 1;
        A(i, i + 1) = A(i + 1, i) = -1;
    }
    for (const double shift : {0.0, -0.1}) {
        const SparseMatrix chain = (A + shift * DenseMatrix::Identity(20, 20)).sparseView();
        try {
            const BandFactor factor(chain, "the chain");
            FAIL() << shift;
        } catch (const NumericalError& error) {
            EXPECT_NE(std::string(error.what()).find("the chain is singular"), std::string::npos) << error.what();
        }
    }
}

}  // namespace
}  // namespace tact
