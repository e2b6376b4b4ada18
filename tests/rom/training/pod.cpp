#include "tact/rom/training/pod.hpp"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <Eigen/SVD>
#include <cmath>

#include "tact/lib/errors.hpp"
#include "tact/rom/training/pod_accumulator.hpp"
#include "tact/tests/rom/chain.hpp"

namespace tact {
namespace {

using testing::identity;
using testing::scattered;

/// Snapshots with singular values 1, decay, decay^2, ...
DenseMatrix decaying(Index n, Index N, double decay) {
    const Index r = std::min(n, N);
    const DenseMatrix left =
        Eigen::HouseholderQR<DenseMatrix>(scattered(n, r)).householderQ() * DenseMatrix::Identity(n, r);
    const DenseMatrix right =
        Eigen::HouseholderQR<DenseMatrix>(scattered(N, r, 2)).householderQ() * DenseMatrix::Identity(N, r);
    Vector sigma(r);
    for (Index j = 0; j < r; ++j) sigma[j] = std::pow(decay, static_cast<double>(j));
    return left * sigma.asDiagonal() * right.transpose();
}

double departure(const DenseMatrix& U) { return (U.transpose() * U - identity(U.cols())).cwiseAbs().maxCoeff(); }

double projection_error(const DenseMatrix& X, const DenseMatrix& U) { return (X - U * (U.transpose() * X)).norm(); }

/// Small, tall, wide; by SVD and by the method of snapshots.
class PodOfShape : public ::testing::TestWithParam<std::pair<Index, Index>> {};

TEST_P(PodOfShape, IsOrthonormalAndOptimalAgainstJacobiSvd) {
    const auto [n, N] = GetParam();
    const DenseMatrix X = decaying(n, N, 0.8);
    const Eigen::JacobiSVD<DenseMatrix> svd(X, Eigen::ComputeThinU | Eigen::ComputeThinV);
    PodOptions options;
    options.rank = 20;
    const Pod result = pod(X, options);
    ASSERT_EQ(result.modes.cols(), 20);
    EXPECT_LT(departure(result.modes), 1e-13);
    EXPECT_LT((result.singular_values - svd.singularValues().head(20)).norm(), 1e-12);
    // Eckart-Young: the error is the tail of the singular values.
    EXPECT_NEAR(projection_error(X, result.modes), svd.singularValues().tail(svd.singularValues().size() - 20).norm(),
                1e-10);
    for (Index j = 0; j < 20; ++j)
        EXPECT_EQ(result.modes.col(j).maxCoeff(), result.modes.col(j).cwiseAbs().maxCoeff());
}

INSTANTIATE_TEST_SUITE_P(Shapes, PodOfShape,
                         ::testing::Values(std::pair<Index, Index>{40, 30}, std::pair<Index, Index>{300, 40},
                                           std::pair<Index, Index>{40, 200}, std::pair<Index, Index>{300, 90},
                                           std::pair<Index, Index>{90, 300}));

TEST(Pod, ReturnsNoMoreModesThanItResolves) {
    DenseMatrix X = scattered(50, 3) * scattered(3, 10, 2);
    PodOptions options;
    options.rank = 8;
    EXPECT_EQ(pod(X, options).modes.cols(), 3);
    EXPECT_EQ(pod(DenseMatrix::Zero(50, 10), options).modes.cols(), 0);
    X = scattered(200, 3) * scattered(3, 100, 2);  // the method of snapshots
    EXPECT_EQ(pod(X, options).modes.cols(), 3);
    options = {};
    options.tolerance = 0.05;
    EXPECT_EQ(pod(decaying(40, 30, 0.5), options).modes.cols(), 5);  // 1, .5, .25, .125, .0625
}

TEST(Pod, IsOrthonormalInTheInnerProductGivenAndOptimalThere) {
    const Index n = 40;
    const DenseMatrix X = decaying(n, 25, 0.7);
    const Vector w = Vector::LinSpaced(n, 0.5, 3);
    const DenseMatrix root = w.cwiseSqrt().asDiagonal();
    const Eigen::JacobiSVD<DenseMatrix> svd(root * X, Eigen::ComputeThinU);
    SparseMatrix sparse(n, n);
    for (Index i = 0; i < n; ++i) sparse.insert(i, i) = w[i];
    for (const Matrix& W : {Matrix::diagonal(w), Matrix(sparse)}) {
        PodOptions options;
        options.rank = 6;
        options.inner_product = W;
        const Pod result = pod(X, options);
        ASSERT_EQ(result.modes.cols(), 6);
        EXPECT_LT((result.modes.transpose() * W.to_dense() * result.modes - identity(6)).norm(), 1e-12);
        EXPECT_LT((result.singular_values - svd.singularValues().head(6)).norm(), 1e-12);
        EXPECT_NEAR(projection_error(root * X, root * result.modes), svd.singularValues().tail(19).norm(), 1e-10);
    }
}

TEST(Pod, RefusesMoreModesThanSnapshotsAndNaN) {
    PodOptions options;
    options.rank = 11;
    DenseMatrix X = scattered(50, 10);
    try {
        pod(X, options);
        FAIL();
    } catch (const InputError& error) {
        EXPECT_STREQ(error.what(), "pod: rank is 11, expected at most the number of snapshots, 10");
    }
    X(3, 3) = std::nan("");
    EXPECT_THROW(pod(X), InputError);
    options = {};
    options.inner_product = Matrix::identity(3);
    EXPECT_THROW(pod(scattered(5, 5), options), InputError);
    options.inner_product = Matrix::diagonal(Vector::Constant(5, -1));
    EXPECT_THROW(pod(scattered(5, 5), options), InputError);
}

TEST(PodAccumulator, GivesThePodOfAllBlocks) {
    const DenseMatrix X = decaying(200, 120, 0.85);
    PodAccumulator accumulator({1e-7, 60});
    accumulator.add(X.leftCols(50));
    accumulator.add(X.middleCols(50, 1));
    accumulator.add(X.middleCols(51, 0));
    accumulator.add(X.rightCols(69));
    EXPECT_EQ(accumulator.snapshots(), 120);
    EXPECT_EQ(accumulator.vectors(), 60);
    PodOptions options;
    options.rank = 20;
    const Pod direct = pod(X, options), merged = accumulator.modes(20);
    EXPECT_LT(departure(merged.modes), 1e-13);
    EXPECT_LT((merged.singular_values - direct.singular_values).norm(), 1e-6);
    EXPECT_LT((merged.modes - direct.modes).norm(), 1e-4);
    EXPECT_LT(projection_error(X, merged.modes), projection_error(X, direct.modes) * (1 + 1e-6));
    EXPECT_LE(projection_error(X, accumulator.modes(60).modes), 2 * std::sqrt(accumulator.forgotten()) + 1e-7);
}

TEST(PodAccumulator, CutsWideBlocksAndForgetsOnlyWhatItMay) {
    const DenseMatrix X = scattered(30, 12) * scattered(12, 1100, 3);
    PodAccumulator accumulator;
    accumulator.add(X);
    EXPECT_EQ(accumulator.vectors(), 12);
    EXPECT_LT(projection_error(X, accumulator.modes(12).modes), 1e-9 * X.norm());
    EXPECT_EQ(accumulator.modes(40).modes.cols(), 12);
}

TEST(PodAccumulator, RefusesBadBlocksAndTooManyModes) {
    PodAccumulator accumulator;
    accumulator.add(scattered(30, 4));
    EXPECT_THROW(accumulator.add(scattered(31, 4)), InputError);
    EXPECT_THROW(accumulator.modes(5), InputError);
    EXPECT_THROW(accumulator.add(DenseMatrix::Constant(30, 1, std::nan(""))), InputError);
}

TEST(PodAccumulator, InAnInnerProductGivesThePodOfAllBlocksThere) {
    const Index n = 80;
    DenseMatrix X = testing::scattered(n, 24);
    for (Index j = 0; j < X.cols(); ++j) X.col(j) *= std::pow(0.6, static_cast<double>(j));
    DenseMatrix W = testing::scattered(n, n, 3);
    W = (W * W.transpose() / n + DenseMatrix::Identity(n, n)).eval();
    for (const Matrix& product : {Matrix(W), Matrix::diagonal(Vector::LinSpaced(n, 0.5, 3))}) {
        PodOptions options;
        options.inner_product = product;
        PodAccumulatorOptions in_product;
        in_product.inner_product = product;
        PodAccumulator accumulator(in_product);
        for (Index k = 0; k < 24; k += 6) accumulator.add(X.middleCols(k, 6));
        const Pod whole = pod(X, options), merged = accumulator.modes(8);
        EXPECT_LT((merged.singular_values - whole.singular_values.head(8)).norm(), 1e-9 * whole.singular_values[0]);
        EXPECT_LT((merged.modes - whole.modes.leftCols(8)).norm(), 1e-5);
        EXPECT_LT((merged.modes.transpose() * product.times(merged.modes) - DenseMatrix::Identity(8, 8)).norm(),
                  1e-12);
        EXPECT_EQ(accumulator.above(merged.singular_values[4] / merged.singular_values[0] * 0.99), 5);
        EXPECT_THROW(accumulator.add(DenseMatrix::Ones(n + 1, 2)), InputError);
    }
    EXPECT_EQ(PodAccumulator().above(0.1), 0);
}

}  // namespace
}  // namespace tact
