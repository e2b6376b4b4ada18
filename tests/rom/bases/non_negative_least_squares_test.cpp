#include "../../../rom/bases/non_negative_least_squares.hpp"

#include <gtest/gtest.h>

#include <Eigen/QR>

#include "../chain.hpp"

namespace tact {
namespace {

using testing::scattered;

/// KKT of the projection of x on the cone of C's columns, from C and x themselves.
void expect_projection(const DenseMatrix& C, const Vector& x, const Vector& f, double tolerance) {
    const Vector slack = C.transpose() * (C * f - x);
    const double size = C.colwise().norm().maxCoeff() * x.norm();
    EXPECT_GE(f.minCoeff(), 0);
    EXPECT_GE(slack.minCoeff(), -tolerance * size);
    EXPECT_LE(f.cwiseProduct(slack).cwiseAbs().maxCoeff(), tolerance * size * std::max(f.maxCoeff(), 1.0));
}

TEST(NonNegativeLeastSquares, SatisfiesTheKktConditionsFromAnyStart) {
    for (int k = 1; k <= 40; ++k) {
        const double seed = 0.37 * k;
        const DenseMatrix C = k % 2 ? scattered(20, 1 + k % 13, seed) : scattered(20, 1 + k % 13, seed).cwiseAbs();
        const Vector x = scattered(20, 1, seed + 5).col(0);
        // Column by column: of the whole product GCC 12 says that it loops beyond its end.
        DenseMatrix S(C.cols(), C.cols());
        for (Index j = 0; j < C.cols(); ++j) S.col(j) = C.transpose() * C.col(j);
        for (const bool warm : {false, true}) {
            Vector f = warm ? Vector(scattered(C.cols(), 1, seed).col(0).cwiseMax(0)) : Vector::Zero(C.cols());
            ASSERT_EQ(non_negative_least_squares(S, C.transpose() * x, f), Outcome::converged);
            expect_projection(C, x, f, 1e-12);
        }
    }
}

TEST(NonNegativeLeastSquares, AgreesWithEveryActiveSetTriedInTurn) {
    const DenseMatrix C = scattered(9, 6, 2.2);
    const Vector x = scattered(9, 1, 7.7).col(0);
    double lowest = x.norm();
    for (unsigned set = 1; set < 64; ++set) {
        std::vector<Index> used;
        for (Index j = 0; j < 6; ++j)
            if (set >> j & 1u) used.push_back(j);
        const DenseMatrix part = C(Eigen::all, used);
        const Vector z = part.colPivHouseholderQr().solve(x);
        if (z.minCoeff() >= 0) lowest = std::min(lowest, (part * z - x).norm());
    }
    Vector f = Vector::Zero(6);
    ASSERT_EQ(non_negative_least_squares(C.transpose() * C, C.transpose() * x, f), Outcome::converged);
    EXPECT_NEAR((C * f - x).norm(), lowest, 1e-13);
}

TEST(NonNegativeLeastSquares, TakesDependentZeroAndRepeatedVectors) {
    DenseMatrix C = scattered(12, 3).cwiseAbs() * scattered(3, 9, 3).cwiseAbs();  // rank 3
    C.col(4) = C.col(1);
    C.col(6).setZero();
    const Vector x = C * Vector::LinSpaced(9, 0.1, 1), away = scattered(12, 1, 9).col(0);
    const DenseMatrix S = C.transpose() * C;
    for (const Vector& target : {x, away, Vector(Vector::Zero(12))})
        for (const double start : {0.0, 1.0}) {
            Vector f = Vector::Constant(9, start);
            ASSERT_EQ(non_negative_least_squares(S, C.transpose() * target, f), Outcome::converged);
            expect_projection(C, target, f, 1e-11);
        }
}

}  // namespace
}  // namespace tact
