#include "tact/lib/kkt.hpp"

#include <gtest/gtest.h>

#include <random>

namespace tact {
namespace {

/// The definition, written out densely entry by entry.
KktResiduals by_definition(const DenseMatrix& A, const DenseMatrix& B, const Vector& b, const Vector& c,
                           const Vector& u, const Vector& lambda) {
    const auto largest = [](const Vector& v) { return v.size() ? v.maxCoeff() : 0.0; };
    const auto over = [](double x, double y) { return x == 0 ? 0 : x / y; };
    const Vector zero = Vector::Zero(lambda.size());
    const Vector gap = B * u - c;
    const double forces =
        largest(A.cwiseAbs() * u.cwiseAbs() + b.cwiseAbs() + B.transpose().cwiseAbs() * lambda.cwiseAbs());
    const double gaps = largest(B.cwiseAbs() * u.cwiseAbs() + c.cwiseAbs());
    const double multipliers = largest(lambda.cwiseAbs());
    KktResiduals r;
    r.stationarity = over(largest((A * u - b - B.transpose() * lambda).cwiseAbs()), forces);
    r.penetration = over(largest((-gap).cwiseMax(zero)), gaps);
    r.negativity = over(largest((-lambda).cwiseMax(zero)), multipliers);
    for (Index i = 0; i < lambda.size(); ++i)
        r.complementarity = std::max(r.complementarity, std::min(over(gap[i], gaps), over(lambda[i], multipliers)));
    return r;
}

TEST(KktResiduals, FollowTheDefinitionForEveryKindOfMatrix) {
    std::mt19937 random(5);
    std::normal_distribution<double> normal;
    const auto fill = [&](auto& x) {
        for (double& v : x.reshaped()) v = normal(random);
    };
    for (const Index n : {1, 7, 40, 600, 1100}) {
        const Index m = n / 2 + 1;
        DenseMatrix A = DenseMatrix::Zero(n, n), B = DenseMatrix::Zero(m, n);
        for (Index i = 0; i < n; ++i)  // a band, so that blocks of diagonals are met, and one far entry
            for (Index j = std::max<Index>(0, i - 2); j < std::min(n, i + 2); ++j) A(i, j) = normal(random);
        A(0, n - 1) = 3;
        for (Index i = 0; i < m; ++i) B(i, (7 * i) % n) = 1 + B(i, i) - normal(random);
        Vector b(n), c(m), u(n), lambda(m);
        fill(b), fill(c), fill(u), fill(lambda);
        const auto expected = by_definition(A, B, b, c, u, lambda);
        for (const auto& [MA, MB] : {std::pair{Matrix(A), Matrix(B)},
                                     std::pair{Matrix(Matrix(A).to_sparse()), Matrix(Matrix(B).to_sparse())}}) {
            const auto r = kkt_residuals(MA, MB, b, c, u, lambda);
            EXPECT_NEAR(r.stationarity, expected.stationarity, 1e-14);
            EXPECT_NEAR(r.penetration, expected.penetration, 1e-14);
            EXPECT_NEAR(r.negativity, expected.negativity, 1e-14);
            EXPECT_NEAR(r.complementarity, expected.complementarity, 1e-14);
        }
        const Vector d = A.diagonal();
        const auto diagonal = kkt_residuals(Matrix::diagonal(d), Matrix::identity(n), b, b, u, u);
        const auto dense = by_definition(d.asDiagonal(), DenseMatrix::Identity(n, n), b, b, u, u);
        EXPECT_NEAR(diagonal.largest(), dense.largest(), 1e-14);
    }
}

TEST(KktResiduals, ZeroOverZeroIsZeroAndNaNIsInfinite) {
    const Matrix I = Matrix::identity(2);
    const Vector zero = Vector::Zero(2);
    EXPECT_EQ(kkt_residuals(I, I, zero, zero, zero, zero).largest(), 0);
    Vector nan = zero;
    nan[1] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(kkt_residuals(I, I, zero, zero, nan, zero).largest(), infinity);
    EXPECT_EQ(kkt_residuals(I, I, nan, zero, zero, zero).largest(), infinity);
    EXPECT_EQ(kkt_residuals(I, I, zero, zero, zero, nan).largest(), infinity);
}

TEST(KktResiduals, ARowAtMinusInfinityIsSkippedButMayCarryNoForce) {
    const Matrix I = Matrix::identity(2);
    const Vector c = Eigen::Vector2d(-infinity, 0), u = Eigen::Vector2d(-5, 0);
    EXPECT_EQ(kkt_residuals(I, I, u, c, u, Vector::Zero(2)).largest(), 0);
    EXPECT_EQ(kkt_residuals(I, I, u, c, u, Eigen::Vector2d(1, 0)).complementarity, infinity);
}

}  // namespace
}  // namespace tact
