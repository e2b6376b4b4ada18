#include "../../../rom/error/relative_error.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "../chain.hpp"

namespace tact {
namespace {

using testing::chain;
using testing::scattered;

constexpr Index n = 300, p = 5, count = 40;  // more rows than one block

TEST(RelativeError, IsTheRatioOfSumsOfEq17) {
    const ContactProblem full = chain(n, -0.5);
    const ReducedBasis basis{scattered(n, p), {}};
    const DenseMatrix u = scattered(n, count, 2), q = 0.2 * scattered(p, count, 3);
    std::vector<double> times(count, 0.0);
    const RelativeError error = relative_error(full, u, basis, q, times);
    double above = 0, below = 0, deepest = 0;
    for (Index j = 0; j < count; ++j) {
        const Vector lifted = basis.U * q.col(j);
        above += (lifted - u.col(j)).squaredNorm();
        below += u.col(j).squaredNorm();
        deepest = std::max(deepest, (full.c.at(0) - full.B.to_dense() * lifted).maxCoeff());
    }
    EXPECT_NEAR(error.squared_percent, 100 * above / below, 1e-10);
    EXPECT_NEAR(error.norm_percent, 100 * std::sqrt(above / below), 1e-10);
    ASSERT_GT(deepest, 0);
    EXPECT_NEAR(error.penetration, deepest / 0.5, 1e-12);
}

TEST(RelativeError, FollowsAMovingGapAndSkipsRowsThatAreOff) {
    ContactProblem full = chain(n);
    const ReducedBasis basis{scattered(n, p), {}};
    const DenseMatrix zero = DenseMatrix::Zero(p, 2), u = DenseMatrix::Ones(n, 2);
    full.c = AffineVector(Vector::Ones(full.constraints()),
                          [](double t, Side, VectorRef out) { out[0] = t - 1; });  // c = t - 1 against B u = 0
    EXPECT_NEAR(relative_error(full, u, basis, zero, {0, 1.5}).penetration, 0.5 / 1, 1e-14);
    EXPECT_EQ(relative_error(full, u, basis, zero, {0, 0.5}).penetration, 0);
    full.c = AffineVector(Vector::Constant(full.constraints(), -infinity).eval());
    full.c.modes(0, 0) = 0.25;
    EXPECT_NEAR(relative_error(full, u, basis, zero, {0, 1}).penetration, 1, 1e-14);
}

TEST(RelativeError, OfALiftedStateIsZeroAndOfTheZeroSolutionIsHonest) {
    const ContactProblem full = chain(n);
    const ReducedBasis basis{scattered(n, p), {}};
    const DenseMatrix q = scattered(p, 3);
    const std::vector<double> times{0, 0, 0};
    EXPECT_LT(relative_error(full, DenseMatrix(basis.U * q), basis, q, times).norm_percent, 1e-12);
    EXPECT_EQ(relative_error(full, DenseMatrix::Zero(n, 3), basis, q, times).norm_percent, infinity);
    EXPECT_EQ(relative_error(full, DenseMatrix::Zero(n, 3), basis, DenseMatrix::Zero(p, 3), times).norm_percent, 0);
}

TEST(RelativeError, RefusesStatesThatDoNotFit) {
    const ContactProblem full = chain(n);
    const ReducedBasis basis{scattered(n, p), {}};
    EXPECT_THROW(relative_error(full, scattered(n, 3), basis, scattered(p, 2), {0, 1, 2}), InputError);
    EXPECT_THROW(relative_error(full, scattered(n - 1, 3), basis, scattered(p, 3), {0, 1, 2}), InputError);
    EXPECT_THROW(relative_error(full, scattered(n, 3), basis, scattered(p + 1, 3), {0, 1, 2}), InputError);
}

}  // namespace
}  // namespace tact
