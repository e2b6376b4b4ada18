#include "../../../lib/sparse/smoothed_aggregation.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <random>

#include "../../../lib/errors.hpp"
#include "random_matrices.hpp"

namespace tact {
namespace {

/// The same matrix, with coefficients that single precision does not hold and in a random numbering.
SparseMatrix shuffled_with_varied_coefficients(const SparseMatrix& A) {
    std::mt19937 random(5);
    Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, long> P(A.rows());
    P.setIdentity();
    std::shuffle(P.indices().data(), P.indices().data() + A.rows(), random);
    Vector scale(A.rows());
    for (double& s : scale) s = 0.7 + 1e-3 * static_cast<double>(random() % 600);
    SparseMatrix scaled = scale.asDiagonal() * A * scale.asDiagonal(), shuffled;
    shuffled = scaled.twistedBy(P);
    return shuffled;
}

/// D^-1/2 A D^-1/2 as the hierarchy orders it, and its cycle as a matrix.
DenseMatrix scaled_dense(const SparseMatrix& A) {
    const Vector scale = A.diagonal().cwiseSqrt().cwiseInverse();
    return scale.asDiagonal() * DenseMatrix(A) * scale.asDiagonal();
}

DenseMatrix cycle_as_matrix(SmoothedAggregation& hierarchy) {
    const int n = hierarchy.size(0);
    DenseMatrix M(n, n);
    Eigen::VectorXf r = Eigen::VectorXf::Zero(hierarchy.padded(0)), z = r;
    for (int j = 0; j < n; ++j) {
        const auto& place = hierarchy.place(0);
        r[place[static_cast<std::size_t>(j)]] = 1;
        hierarchy.cycle(r.data(), z.data());
        for (int i = 0; i < n; ++i) M(i, j) = z[place[static_cast<std::size_t>(i)]];
        r[place[static_cast<std::size_t>(j)]] = 0;
    }
    return M;
}

std::vector<int> every_seventh(const SmoothedAggregation& hierarchy) {
    std::vector<int> masked;
    for (int i = 3; i < hierarchy.size(0); i += 7) masked.push_back(hierarchy.place(0)[static_cast<std::size_t>(i)]);
    return masked;
}

TEST(SmoothedAggregation, TheCycleIsSymmetricAndCloseToTheInverse) {
    for (const SparseMatrix& A : {test::laplacian(24), shuffled_with_varied_coefficients(test::laplacian(24))}) {
        SmoothedAggregation hierarchy(compressed_columns(A));
        ASSERT_GE(hierarchy.levels(), 2);
        const DenseMatrix M = cycle_as_matrix(hierarchy);
        EXPECT_LT((M - M.transpose()).norm(), 1e-5 * M.norm());
        const Vector spectrum = Eigen::MatrixXd(M * scaled_dense(A)).eigenvalues().real();
        EXPECT_GT(spectrum.minCoeff(), 0.3);
        EXPECT_LT(spectrum.maxCoeff(), 1.1);
    }
}

TEST(SmoothedAggregation, AMaskedCycleIsSymmetricPositiveDefiniteOnTheOthers) {
    const SparseMatrix A = test::laplacian(24);
    SmoothedAggregation hierarchy(compressed_columns(A));
    const DenseMatrix unmasked = cycle_as_matrix(hierarchy);
    const auto masked = every_seventh(hierarchy);
    hierarchy.mask(0, masked);
    const DenseMatrix M = cycle_as_matrix(hierarchy);
    EXPECT_LT((M - M.transpose()).norm(), 1e-5 * M.norm());
    Index zero = 0;
    for (Index i = 0; i < M.rows(); ++i) zero += M.row(i).isZero(0) && M.col(i).isZero(0);
    EXPECT_EQ(zero, static_cast<Index>(masked.size()));
    const Vector spectrum = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(M).eigenvalues();
    EXPECT_GT(spectrum[zero], 1e-3);
    EXPECT_GT(spectrum[0], -1e-5);
    hierarchy.mask(0, {});
    EXPECT_EQ(cycle_as_matrix(hierarchy), unmasked);
}

TEST(SmoothedAggregation, ResidualsAndProductsAgreeWithTheMatrix) {
    for (const SparseMatrix& A :
         {test::laplacian(13), shuffled_with_varied_coefficients(test::laplacian(13)), test::laplacian(3)}) {
        SmoothedAggregation hierarchy(compressed_columns(A));
        const DenseMatrix S = scaled_dense(A);
        std::mt19937 random(1);
        std::normal_distribution<double> normal;
        Vector x(A.rows()), b(A.rows());
        Vector px = Vector::Zero(hierarchy.padded(0)), pb = px, pr = px;
        const auto& place = hierarchy.place(0);
        for (Index i = 0; i < A.rows(); ++i) {
            px[place[static_cast<std::size_t>(i)]] = x[i] = normal(random);
            pb[place[static_cast<std::size_t>(i)]] = b[i] = normal(random);
        }
        hierarchy.residual(pb.data(), px.data(), pr.data());
        const Vector r = b - S * x;
        const Eigen::VectorXf p = px.cast<float>();
        Eigen::VectorXf q = Eigen::VectorXf::Zero(px.size());
        EXPECT_NEAR(hierarchy.multiply(0, p.data(), q.data(), {}), x.dot(S * x), 1e-4 * x.squaredNorm());
        for (Index i = 0; i < A.rows(); ++i) {
            const int at = place[static_cast<std::size_t>(i)];
            ASSERT_NEAR(pr[at], r[i], 1e-14);
            ASSERT_NEAR(hierarchy.residual(static_cast<int>(i), pb.data(), px.data()), r[i], 1e-14);
            ASSERT_NEAR(q[at], (S * x)[i], 1e-5);
        }
    }
}

TEST(SmoothedAggregation, ADiagonalWithoutSignIsRefused) {
    SparseMatrix A = test::laplacian(4);
    A.coeffRef(5, 5) = 0;
    EXPECT_THROW(SmoothedAggregation(compressed_columns(A)), NumericalError);
}

}  // namespace
}  // namespace tact
