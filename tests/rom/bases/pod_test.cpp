#include "../../../rom/bases/pod.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <cmath>

#include "../../../lib/errors.hpp"
#include "../../../rom/bases/pod_accumulator.hpp"
#include "../chain.hpp"

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

/// Of the angles between two spans of orthonormal columns the sine of the largest.
double largest_sine(const DenseMatrix& A, const DenseMatrix& B) {
    return Eigen::JacobiSVD<DenseMatrix>(A - B * (B.transpose() * A)).singularValues()[0];
}

PodOptions sketched(Index rank, double tolerance = 0, RandomisedSketch sketch = {10, 2}) {
    PodOptions options;
    options.rank = rank;
    options.tolerance = tolerance;
    options.sketch = sketch;
    return options;
}

TEST(RandomisedPod, HasTheModesAndValuesOfJacobiSvdInEachInnerProduct) {
    const Index n = 150, N = 110, r = 15;
    const DenseMatrix X = decaying(n, N, 0.7);
    SparseMatrix K(n, n);
    for (Index i = 0; i < n; ++i) {
        K.insert(i, i) = 2.5 + 0.01 * static_cast<double>(i);
        if (i > 0) K.insert(i, i - 1) = K.insert(i - 1, i) = -1;
    }
    for (const std::optional<Matrix>& W :
         {std::optional<Matrix>(), std::optional(Matrix::diagonal(Vector::LinSpaced(n, 0.5, 3))),
          std::optional(Matrix(K))}) {
        const DenseMatrix dense = W ? W->to_dense() : identity(n);
        const DenseMatrix root = Eigen::LLT<DenseMatrix>(dense).matrixU();  // |x|_W = |root x|
        const Eigen::JacobiSVD<DenseMatrix> svd(root * X, Eigen::ComputeThinU);
        PodOptions options = sketched(r);
        options.inner_product = W;
        const Pod result = pod(X, options);
        ASSERT_EQ(result.modes.cols(), r);
        EXPECT_LT(departure(root * result.modes), 1e-12);
        EXPECT_LT(
            ((result.singular_values - svd.singularValues().head(r)).array() / svd.singularValues().head(r).array())
                .abs()
                .maxCoeff(),
            1e-10);
        EXPECT_LT(largest_sine(root * result.modes, svd.matrixU().leftCols(r)), 1e-6);
        EXPECT_NEAR(projection_error(root * X, root * result.modes), svd.singularValues().tail(N - r).norm(), 1e-9);
    }
}

TEST(RandomisedPod, IsOnAverageWithinTheBoundOfHalkoMartinssonAndTropp) {
    const Index n = 130, N = 100, r = 12;
    DenseMatrix X = decaying(n, N, 1);  // then singular values that fall slowly, where sketches are at their worst
    Vector sigma(N);
    for (Index j = 0; j < N; ++j) sigma[j] = 1 / std::sqrt(static_cast<double>(j + 1));
    const Eigen::JacobiSVD<DenseMatrix> parts(X, Eigen::ComputeThinU | Eigen::ComputeThinV);
    X = parts.matrixU() * sigma.asDiagonal() * parts.matrixV().transpose();
    for (const int q : {0, 1, 2, 3}) {
        const double k = 6, s = 2 * q + 1;
        const double tail = std::sqrt(sigma.tail(N - r).array().pow(2 * s).sum());
        const double bound = sigma[r] + std::pow((1 + std::sqrt(r / (k - 1))) * std::pow(sigma[r], s) +
                                                     std::exp(1.0) * std::sqrt(r + k) / k * tail,
                                                 1 / s);
        double mean = 0;
        constexpr int seeds = 20;
        for (std::uint64_t seed = 0; seed < seeds; ++seed) {
            const DenseMatrix U = pod(X, sketched(r, 0, {static_cast<Index>(k), q, seed})).modes;
            const double error = Eigen::JacobiSVD<DenseMatrix>(X - U * (U.transpose() * X)).singularValues()[0];
            EXPECT_GE(error, sigma[r] * (1 - 1e-12));  // Eckart-Young
            mean += error / seeds;
        }
        EXPECT_LE(mean, bound);
    }
}

TEST(RandomisedPod, FindsAsManyModesAsTheToleranceAsksWhateverTheFirstWidth) {
    const DenseMatrix X = decaying(400, 300, 0.93);
    for (const double tolerance : {0.5, 0.05, 1e-3}) {
        PodOptions options;
        options.tolerance = tolerance;
        const Pod exact = pod(X, options), found = pod(X, sketched(0, tolerance));
        ASSERT_EQ(found.modes.cols(), exact.modes.cols());
        EXPECT_LT((found.singular_values - exact.singular_values).norm(), 1e-5 * tolerance);
    }
    EXPECT_EQ(pod(X, sketched(20, 0.5)).modes.cols(), pod(X, sketched(0, 0.5)).modes.cols());
}

TEST(RandomisedPod, RepeatsItselfToTheLastBitForASeed) {
    const DenseMatrix X = decaying(200, 150, 0.8);
    const auto with_seed = [&](std::uint64_t seed) { return pod(X, sketched(10, 0, {10, 2, seed})); };
    const Pod once = with_seed(7), again = with_seed(7), other = with_seed(8);
    EXPECT_EQ(once.modes, again.modes);
    EXPECT_EQ(once.singular_values, again.singular_values);
    EXPECT_NE(once.modes, other.modes);
    EXPECT_LT(largest_sine(once.modes, other.modes), 1e-4);
}

TEST(RandomisedPod, OfFewerDirectionsThanAskedGivesThose) {
    const DenseMatrix deficient = scattered(200, 3) * scattered(3, 100, 2);
    for (const PodOptions& options : {sketched(8), sketched(100), sketched(0), sketched(0, 1e-6)}) {
        const Pod found = pod(deficient, options);
        ASSERT_EQ(found.modes.cols(), 3);
        EXPECT_LT(departure(found.modes), 1e-13);
        EXPECT_LT(projection_error(deficient, found.modes), 1e-11 * deficient.norm());
    }
    const DenseMatrix column = scattered(200, 1);
    EXPECT_LT(projection_error(column, pod(column, sketched(1)).modes), 1e-13);
    EXPECT_EQ(pod(DenseMatrix::Zero(200, 100), sketched(8)).modes.cols(), 0);
    EXPECT_EQ(pod(DenseMatrix(200, 0), sketched(0)).modes.cols(), 0);
    EXPECT_THROW(pod(deficient, sketched(101)), InputError);
    EXPECT_THROW(pod(deficient, sketched(8, 0, {-1})), InputError);
    EXPECT_THROW(pod(deficient, sketched(8, 0, {10, -1})), InputError);
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
