#include "../../../rom/greedy/sampling.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "../../../lib/errors.hpp"

namespace tact {
namespace {

const Parameter lower = Eigen::Vector2d(0.3, 0.2), upper = Eigen::Vector2d(0.6, 0.6);

TEST(TensorGrid, CellCentredStaysOffTheFacesAndFirstParameterIsFastest) {
    const auto points = tensor_grid(lower, upper, {10, 4});
    ASSERT_EQ(points.size(), 40u);
    EXPECT_NEAR(points[0][0], 0.315, 1e-15);
    EXPECT_NEAR(points[0][1], 0.25, 1e-15);
    EXPECT_NEAR(points[1][0], 0.345, 1e-15);
    EXPECT_EQ(points[1][1], points[0][1]);
    EXPECT_NEAR(points[39][0], 0.585, 1e-15);
    EXPECT_NEAR(points[39][1], 0.55, 1e-15);
}

TEST(TensorGrid, ClosedHoldsTheCornersExactly) {
    const auto points = tensor_grid(lower, upper, {3, 2}, GridKind::closed);
    ASSERT_EQ(points.size(), 6u);
    EXPECT_EQ(points.front(), lower);
    EXPECT_EQ(points.back(), upper);
    EXPECT_NEAR(points[1][0], 0.45, 1e-15);
}

TEST(LatinHypercube, HasOnePointInEachSliceOfEachParameter) {
    const Index count = 23;
    const auto points = latin_hypercube(lower, upper, count, 11);
    for (Index k = 0; k < 2; ++k) {
        std::vector<int> hits(static_cast<std::size_t>(count), 0);
        for (const Parameter& x : points) {
            const double place = (x[k] - lower[k]) / (upper[k] - lower[k]) * static_cast<double>(count);
            ++hits.at(static_cast<std::size_t>(std::floor(place)));
        }
        EXPECT_EQ(std::count(hits.begin(), hits.end(), 1), count);
    }
}

TEST(LatinHypercube, IsDecidedByItsSeed) {
    EXPECT_EQ(latin_hypercube(lower, upper, 9, 5), latin_hypercube(lower, upper, 9, 5));
    EXPECT_NE(latin_hypercube(lower, upper, 9, 5), latin_hypercube(lower, upper, 9, 6));
}

/// The digits of i in this base, behind the point in reverse order.
double radical_inverse(Index i, Index base) {
    double x = 0;
    for (double place = 1.0 / static_cast<double>(base); i > 0; i /= base, place /= static_cast<double>(base))
        x += static_cast<double>(i % base) * place;
    return x;
}

TEST(HaltonSequence, IsTheRadicalInverse) {
    const auto points = halton_sequence(lower, upper, 50);
    ASSERT_EQ(points.size(), 50u);
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Index number = static_cast<Index>(i) + 1;
        EXPECT_NEAR(points[i][0], 0.3 + 0.3 * radical_inverse(number, 2), 1e-14);
        EXPECT_NEAR(points[i][1], 0.2 + 0.4 * radical_inverse(number, 3), 1e-14);
    }
}

TEST(SobolSequence, WithTheOriginFillsEveryElementaryBoxOnce) {
    // The defining property of a (0, 4, 2)-net in base 2, of the first 16 points, the origin among them.
    const Parameter zero = Eigen::Vector2d::Zero(), one = Eigen::Vector2d::Ones();
    auto points = sobol_sequence(zero, one, 15);
    EXPECT_EQ(points.front(), one / 2);
    points.push_back(zero);
    for (Index bits = 0; bits <= 4; ++bits) {
        std::vector<int> hits(16, 0);
        for (const Parameter& x : points) {
            const auto i = static_cast<Index>(x[0] * static_cast<double>(1 << bits));
            const auto j = static_cast<Index>(x[1] * static_cast<double>(1 << (4 - bits)));
            ++hits[static_cast<std::size_t>((i << (4 - bits)) + j)];
        }
        EXPECT_EQ(hits, std::vector<int>(16, 1)) << bits;
    }
    EXPECT_EQ(sobol_sequence(lower, upper, 7)[0], (lower + upper) / 2);
}

TEST(NearestToCentre, MeasuresInUnitsOfTheBoxAndTakesTheFirstOfEquals) {
    // Four points of an even grid are equally near.
    EXPECT_EQ(nearest_to_centre(tensor_grid(lower, upper, {10, 10}), lower, upper), 44);
    EXPECT_EQ(nearest_to_centre(tensor_grid(lower, upper, {3, 3}), lower, upper), 4);
    const Parameter low = Eigen::Vector2d(0, 0), high = Eigen::Vector2d(1, 1000);
    EXPECT_EQ(nearest_to_centre({Eigen::Vector2d(0.9, 500), Eigen::Vector2d(0.5, 600)}, low, high), 1);
}

TEST(Sampling, RefusesBadCountsAndBoxes) {
    EXPECT_THROW(tensor_grid(lower, upper, {10}), InputError);
    EXPECT_THROW(tensor_grid(lower, upper, {10, 0}), InputError);
    EXPECT_THROW(tensor_grid(lower, upper, {10, 1}, GridKind::closed), InputError);
    EXPECT_THROW(tensor_grid(upper, lower, {10, 10}), InputError);
    EXPECT_THROW(tensor_grid(lower, Parameter(Vector::Ones(3)), {10, 10}), InputError);
    EXPECT_THROW(latin_hypercube(lower, upper, 0, 1), InputError);
    EXPECT_THROW(latin_hypercube(lower, Parameter(Eigen::Vector2d(infinity, 1)), 3, 1), InputError);
    EXPECT_THROW(nearest_to_centre({}, lower, upper), InputError);
    for (const auto sequence : {sobol_sequence, halton_sequence}) {
        EXPECT_THROW(sequence(lower, upper, 0), InputError);
        EXPECT_THROW(sequence(upper, lower, 3), InputError);
        EXPECT_THROW(sequence(Vector::Zero(1300), Vector::Ones(1300), 3), InputError);
    }
}

}  // namespace
}  // namespace tact
