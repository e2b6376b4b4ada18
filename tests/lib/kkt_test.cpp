#include "../../lib/kkt.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <random>
#include <vector>

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

TEST(KktResiduals, FollowTheDefinitionOnAMeshOfEqualCellsInAnyNumbering) {
    std::mt19937 random(7);
    std::normal_distribution<double> normal;
    constexpr Index side = 37, n = side * side;
    std::vector<Index> numbers(n);
    std::iota(numbers.begin(), numbers.end(), Index{0});
    for (const bool shuffled : {false, true}) {
        if (shuffled) std::shuffle(numbers.begin(), numbers.end(), random);
        const auto number = [&](Index i, Index j) { return numbers[static_cast<std::size_t>(i + side * j)]; };
        DenseMatrix A = DenseMatrix::Zero(n, n), B = DenseMatrix::Zero(n / 2, n);
        for (Index j = 0; j < side; ++j)
            for (Index i = 0; i < side; ++i) {
                A(number(i, j), number(i, j)) = 4;
                if (i > 0) A(number(i, j), number(i - 1, j)) = -1.5;  // not symmetric
                if (i + 1 < side) A(number(i, j), number(i + 1, j)) = -1;
                if (j > 0) A(number(i, j), number(i, j - 1)) = -2;
                if (j + 1 < side) A(number(i, j), number(i, j + 1)) = -0.5;
            }
        for (Index i = 0; i < n / 2; ++i) {  // pairs
            B(i, numbers[static_cast<std::size_t>(i)]) = 1;
            B(i, numbers[static_cast<std::size_t>(i + n / 2)]) = -1;
        }
        Vector b(n), c(n / 2), u(n), lambda(n / 2);
        for (Vector* v : {&b, &c, &u, &lambda})
            for (double& x : *v) x = normal(random);
        const auto expected = by_definition(A, B, b, c, u, lambda);
        const auto r = kkt_residuals(Matrix(Matrix(A).to_sparse()), Matrix(Matrix(B).to_sparse()), b, c, u, lambda);
        EXPECT_NEAR(r.stationarity, expected.stationarity, 1e-14);
        EXPECT_NEAR(r.penetration, expected.penetration, 1e-14);
        EXPECT_NEAR(r.negativity, expected.negativity, 1e-14);
        EXPECT_NEAR(r.complementarity, expected.complementarity, 1e-14);
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

TEST(KktResiduals, WhereTermsOverflowNoGapIsCalledClosed) {
    const double huge = std::numeric_limits<double>::max();
    DenseMatrix B(1, 1);
    B << huge;
    const Vector one = Vector::Ones(1), none = Vector::Zero(1);
    // u >= 1, and u = .26: |B||u| + |c| is infinite.
    const KktResiduals kkt = kkt_residuals(Matrix::identity(1), Matrix(B), 0.26 * one, huge * one, 0.26 * one, none);
    EXPECT_EQ(kkt.largest(), infinity);
}

TEST(KktResiduals, WhatHasDecayedIntoUnderflowCountsAsZero) {
    // A motion that halves each step gets there after a thousand: a digit that is lost is then the whole force.
    const Matrix I = Matrix::identity(1);
    const Vector tiny = Vector::Constant(1, 5e-309), zero = Vector::Zero(1);
    EXPECT_LT(kkt_residuals(I, I, tiny, zero, zero, zero).largest(), 1e-12);
    EXPECT_LT(kkt_residuals(I, I, -tiny, zero, -tiny, zero).largest(), 1e-12);
    EXPECT_EQ(kkt_residuals(I, I, 1e20 * tiny, zero, zero, zero).stationarity, 1) << "small is not zero";
}

TEST(KktResiduals, ARowAtMinusInfinityIsSkippedButMayCarryNoForce) {
    const Matrix I = Matrix::identity(2);
    const Vector c = Eigen::Vector2d(-infinity, 0), u = Eigen::Vector2d(-5, 0);
    EXPECT_EQ(kkt_residuals(I, I, u, c, u, Vector::Zero(2)).largest(), 0);
    EXPECT_EQ(kkt_residuals(I, I, u, c, u, Eigen::Vector2d(1, 0)).complementarity, infinity);
}

}  // namespace
}  // namespace tact
