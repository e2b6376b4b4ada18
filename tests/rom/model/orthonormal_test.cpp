#include "../../../rom/model/orthonormal.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "../chain.hpp"

namespace tact {
namespace {

using testing::identity;
using testing::scattered;

double departure(const DenseMatrix& Q) { return (Q.transpose() * Q - identity(Q.cols())).cwiseAbs().maxCoeff(); }

TEST(OrthonormalColumns, HaveTheSpanOfTheirInput) {
    const DenseMatrix X = scattered(80, 37);
    const DenseMatrix Q = orthonormal_columns(X);
    ASSERT_EQ(Q.cols(), 37);
    EXPECT_LT(departure(Q), 1e-14);
    EXPECT_LT((X - Q * (Q.transpose() * X)).norm(), 1e-13 * X.norm());
}

TEST(OrthonormalColumns, AreOrthonormalHoweverIllConditionedTheInput) {
    DenseMatrix X(100, 22);  // monomials on [0, 1]: condition about 1e16
    for (Index j = 0; j < X.cols(); ++j)
        for (Index i = 0; i < X.rows(); ++i) X(i, j) = std::pow(static_cast<double>(i) / 100, static_cast<double>(j));
    EXPECT_LT(departure(orthonormal_columns(X, 1e-13)), 1e-13);
}

TEST(OrthonormalColumns, DropColumnsThatAreZeroOrDependOnEarlierOnes) {
    DenseMatrix X = scattered(50, 40);
    X.col(3).setZero();
    X.col(20) = X.col(1) - 2 * X.col(18);
    X.col(39) = 1e-9 * X.col(0) + 1e-9 * X.col(30);
    const DenseMatrix Q = orthonormal_columns(X);
    ASSERT_EQ(Q.cols(), 37);
    EXPECT_LT(departure(Q), 1e-14);
    EXPECT_LT((X - Q * (Q.transpose() * X)).norm(), 1e-12 * X.norm());
    EXPECT_EQ(orthonormal_columns(DenseMatrix::Zero(5, 2)).cols(), 0);
}

TEST(FixSigns, MakesTheLargestEntryPositiveAndTheFirstOfEqualsDecide) {
    DenseMatrix X(3, 3);
    X << 1, -2, 0, -3, 2 + 1e-12, 0, 2, 1, 0;
    fix_signs(X);
    DenseMatrix expected(3, 3);
    expected << -1, 2, 0, 3, -2 - 1e-12, 0, -2, -1, 0;
    EXPECT_EQ(X, expected);
}

}  // namespace
}  // namespace tact
