#include "../../../lib/sparse/lanczos.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "random_matrices.hpp"

namespace tact {
namespace {

Vector scaled_eigenvalues(const SparseMatrix& A) {
    const Vector scale = Vector(A.diagonal()).cwiseSqrt().cwiseInverse();
    const DenseMatrix S = scale.asDiagonal() * DenseMatrix(A) * scale.asDiagonal();
    return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(S, Eigen::EigenvaluesOnly).eigenvalues();
}

TEST(ScaledSpectrum, AllStepsGiveTheWholeSpectrum) {
    for (unsigned seed = 1; seed <= 10; ++seed) {
        const SparseMatrix A = test::badly_scaled(test::random_spd(30, 2, 1, seed), 2, seed);
        const Vector exact = scaled_eigenvalues(A);
        const auto estimate = scaled_spectrum(Matrix(A), 100);
        EXPECT_NEAR(estimate.smallest, exact.minCoeff(), 1e-10);
        EXPECT_NEAR(estimate.largest, exact.maxCoeff(), 1e-10);
        EXPECT_NEAR(estimate.condition(), exact.maxCoeff() / exact.minCoeff(), 1e-7 * estimate.condition());
    }
}

TEST(ScaledSpectrum, AFewStepsStayWithinTheSpectrumAndComeClose) {
    for (unsigned seed = 1; seed <= 10; ++seed) {
        const SparseMatrix A = test::random_spd(300, 2, 1, seed);
        const Vector exact = scaled_eigenvalues(A);
        const auto estimate = scaled_spectrum(Matrix(A));
        EXPECT_GE(estimate.smallest, exact.minCoeff() - 1e-12);
        EXPECT_LE(estimate.largest, exact.maxCoeff() + 1e-12);
        EXPECT_LT(estimate.smallest, 2 * exact.minCoeff());
        EXPECT_GT(estimate.largest, 0.98 * exact.maxCoeff());
    }
}

TEST(ScaledSpectrum, IsNotDeceivedByTheScalingOfTheUnknowns) {
    const SparseMatrix A = test::laplacian(12);
    const auto estimate = scaled_spectrum(Matrix(A));
    const auto rescaled = scaled_spectrum(Matrix(test::badly_scaled(A, 6, 1)));
    EXPECT_NEAR(estimate.smallest, rescaled.smallest, 1e-8);
    EXPECT_NEAR(estimate.largest, rescaled.largest, 1e-8);
}

TEST(ScaledSpectrum, TellsADiagonalFromAnIndefiniteMatrix) {
    EXPECT_NEAR(scaled_spectrum(Matrix::diagonal(Vector::LinSpaced(40, 1, 1e6))).condition(), 1, 1e-12);
    SparseMatrix A = test::laplacian(6);
    for (double& x : A.coeffs()) x = x < 0 ? -2 : x;
    EXPECT_EQ(scaled_spectrum(Matrix(A), 36).condition(), infinity);
}

}  // namespace
}  // namespace tact
