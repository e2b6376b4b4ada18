#include "../../../rom/model/empirical_interpolation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "../../../lib/errors.hpp"
#include "../../../rom/model/chebyshev_series.hpp"
#include "../chain.hpp"

namespace tact {
namespace {

Vector bump(double place, Index n = 80) {
    const Vector x = Vector::LinSpaced(n, 0, 1);
    return (0.2 + (-40 * (x.array() - place).square()).exp()).matrix();
}

DenseMatrix bumps(Index count) {
    DenseMatrix X(80, count);
    for (Index j = 0; j < count; ++j) X.col(j) = bump(static_cast<double>(j) / static_cast<double>(count - 1));
    return X;
}

TEST(EmpiricalInterpolation, IsExactAtItsPoints) {
    const auto few = interpolate_empirically(bumps(60), 1e-4, 50);
    ASSERT_GT(few.size(), 3);
    EXPECT_EQ(DenseMatrix(few.modes(few.points, Eigen::all)), testing::identity(few.size()));
    for (const double place : {0.123, 0.5001, 0.97}) {
        const Vector x = bump(place);
        const Vector y = few.modes * x(few.points);
        EXPECT_EQ(Vector(y(few.points)), Vector(x(few.points)));
    }
}

TEST(EmpiricalInterpolation, ReachesItsToleranceWithFewTermsAndKnowsItsError) {
    const DenseMatrix X = bumps(200);
    Index before = 0;
    for (const double tolerance : {1e-2, 1e-5, 1e-9}) {
        const auto few = interpolate_empirically(X, tolerance, 80);
        const DenseMatrix rest = X - few.modes * X(few.points, Eigen::all);
        const double error = rest.cwiseAbs().maxCoeff() / X.cwiseAbs().maxCoeff();
        EXPECT_LE(few.error, tolerance);
        EXPECT_NEAR(error, few.error, 1e-12);
        EXPECT_GT(few.size(), before);
        EXPECT_LT(few.size(), 40);
        before = few.size();
    }
    EXPECT_EQ(interpolate_empirically(X, 0, 5).size(), 5);
}

TEST(EmpiricalInterpolation, ReproducesVectorsThatAreAffineInFewFunctions) {
    const DenseMatrix terms = testing::scattered(50, 3);
    const auto few = interpolate_empirically(terms * testing::scattered(3, 40, 2), 1e-12, 50);
    EXPECT_EQ(few.size(), 3);
    const Vector x = terms * Vector::LinSpaced(3, -2, 5);
    EXPECT_LT((few.modes * x(few.points) - x).norm(), 1e-11 * x.norm());
}

TEST(EmpiricalInterpolation, OfZerosHasNoTermsAndRefusesNaN) {
    EXPECT_EQ(interpolate_empirically(DenseMatrix::Zero(4, 5), 1e-8, 5).size(), 0);
    DenseMatrix X = bumps(5);
    X(3, 2) = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(interpolate_empirically(X, 1e-8, 5), InputError);
}

TEST(ChebyshevSeries, ReproducesPolynomialsWithAsFewTermsAsTheyHave) {
    const Parameter lower = Eigen::Vector3d(-1, 2, 0.5), upper = Eigen::Vector3d(3, 4, 0.5);
    const ParameterFunction f = [](const Parameter& g, VectorRef out) {
        out[0] = 1 + g[0] * g[0] * g[1];
        out[1] = g[2] - g[0];
    };
    const ChebyshevFit fit = fit_chebyshev(f, 2, lower, upper);
    EXPECT_TRUE(fit.resolved);
    EXPECT_EQ(fit.series.counts, (std::vector<Index>{3, 2, 1}));
    EXPECT_LT(fit.error, 1e-14);
    const Vector value = fit.series.at(Eigen::Vector3d(2.5, 3.1, 0.5));
    EXPECT_NEAR(value[0], 1 + 2.5 * 2.5 * 3.1, 1e-12);
    EXPECT_NEAR(value[1], 0.5 - 2.5, 1e-12);
}

TEST(ChebyshevSeries, ResolvesASmoothFunctionAndMeasuresWhatItCannot) {
    const Parameter lower = Eigen::Vector2d(0.3, 0.2), upper = Eigen::Vector2d(0.6, 0.6);
    const ParameterFunction smooth = [](const Parameter& g, VectorRef out) {
        out[0] = std::exp(-200 * (g[0] - 0.4) * (g[0] - 0.4)) * (1 + g[1]);
    };
    const ChebyshevFit fine = fit_chebyshev(smooth, 1, lower, upper);
    EXPECT_TRUE(fine.resolved);
    EXPECT_LT(fine.error, 1e-10);
    EXPECT_EQ(fine.series.counts[1], 2);
    const ParameterFunction kink = [](const Parameter& g, VectorRef out) { out[0] = std::abs(g[0] - 0.4321); };
    const ChebyshevFit coarse = fit_chebyshev(kink, 1, lower, upper);
    EXPECT_FALSE(coarse.resolved);
    EXPECT_GT(coarse.error, 1e-4);
    EXPECT_LT(coarse.error, 0.1);
    EXPECT_TRUE(fit_chebyshev(smooth, 1, Vector::Zero(9), Vector::Ones(9)).series.empty());
    EXPECT_THROW(fit_chebyshev(smooth, 1, upper, lower), InputError);
}

TEST(ChebyshevSeries, PointsFillTheBox) {
    const auto points = spread_points(Eigen::Vector2d(0, -1), Eigen::Vector2d(1, 1), 100);
    Eigen::Matrix2i quarters = Eigen::Matrix2i::Zero();
    for (const Parameter& g : points) ++quarters(g[0] < 0.5, g[1] < 0);
    EXPECT_GE(quarters.minCoeff(), 22);
    EXPECT_EQ(spread_points({}, {}, 10).size(), 1U);
}

}  // namespace
}  // namespace tact
