#include "../../../lib/scenes/american_put.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "../../../contact/automatic.hpp"
#include "../../../integrators/sundials/bdf2.hpp"
#include "../../../lib/errors.hpp"

namespace tact {
namespace {

/// The binomial tree of Cox, Ross and Rubinstein, one year, strike 100, rate .05, volatility .2.
struct Tree {
    int steps;
    double dt = 1.0 / steps, up = std::exp(0.2 * std::sqrt(dt)), discount = std::exp(-0.05 * dt);
    double p = (1 / discount - 1 / up) / (up - 1 / up);

    /// Of holding the put at least one step longer at the price S.
    double hold(double S) const {
        std::vector<double> price(std::size_t(2 * steps + 1)), value(std::size_t(steps + 1));
        for (int k = 0; k <= 2 * steps; ++k) price[std::size_t(k)] = S * std::pow(up, k - steps);
        const auto payoff = [&](int level, int k) {
            return std::max(100 - price[std::size_t(2 * k - level + steps)], 0.0);
        };
        for (int k = 0; k <= steps; ++k) value[std::size_t(k)] = payoff(steps, k);
        for (int level = steps - 1; level >= 0; --level)
            for (int k = 0; k <= level; ++k) {
                const std::size_t j = std::size_t(k);
                const double held = discount * (p * value[j + 1] + (1 - p) * value[j]);
                value[j] = level == 0 ? held : std::max(held, payoff(level, k));
            }
        return value[0];
    }
    /// Below it exercising is worth more.
    double exercise() const {
        double low = 50, high = 100;
        while (high - low > 1e-3) {
            const double S = (low + high) / 2;
            (hold(S) <= 100 - S ? low : high) = S;
        }
        return low;
    }
};

struct Put {
    double value, exercise;
    MarchReport march;
};

Put run(Index cells, double dt) {
    const auto [problem, mesh] = american_put(cells);
    ContactWorkspace workspace(std::make_shared<AutomaticContact>());
    const auto march = integrate(Bdf2{}, problem, TimeGrid::until(1, dt), workspace);
    EXPECT_EQ(march.outcome, Outcome::converged);
    EXPECT_LE(march.worst_kkt.largest(), 1e-10);
    return {value_on_line(mesh, march.final_state.u(), 100), exercise_price(mesh, march.final_state.lambda), march};
}

TEST(AmericanPut, ValueGoesToThatOfTheBinomialTree) {
    const double tree = (Tree{2000}.hold(100) + Tree{2001}.hold(100)) / 2;
    EXPECT_NEAR(tree, 6.0904, 2e-4);
    const double coarse = std::abs(run(75, 0.02).value - tree), middle = std::abs(run(150, 0.01).value - tree),
                 fine = std::abs(run(300, 0.005).value - tree);
    EXPECT_LT(middle, coarse / 3);
    EXPECT_LT(fine, middle / 3);
    EXPECT_LT(fine, 4e-3);
    EXPECT_NEAR(run(1200, 0.00125).value, 6.0904, 3e-4);
}

TEST(AmericanPut, IsExercisedWhereTheBinomialTreeDoes) {
    // The tree may only exercise at its levels: its price is too high by the root of their distance, and is extrapolated.
    const double tree = 2 * Tree{2000}.exercise() - Tree{500}.exercise();
    EXPECT_NEAR(tree, 80.88, 0.01);
    for (const Index cells : {300, 1200})
        EXPECT_NEAR(run(cells, 0.0025).exercise, tree, 300.0 / double(cells)) << cells;
}

TEST(AmericanPut, IsAnObstacleProblemOfFirstOrder) {
    const auto [problem, mesh] = american_put(30);
    validate(problem);
    EXPECT_FALSE(problem.second_order());
    EXPECT_FALSE(problem.is_static());
    EXPECT_FALSE(problem.K.is_symmetric());
    const DenseMatrix K = problem.K.to_dense();
    EXPECT_LE((K - DenseMatrix(K.diagonal().asDiagonal())).maxCoeff(), 0) << "the signs of an M-matrix";
    // On u = S and u = S^2 the differences are exact where they are central: r S - r S = 0, and -(sigma^2 + r) S^2.
    const Vector S = mesh.bodies[0].line, squares = S.array().square();
    const Vector first = K * S, second = K * squares, terms = K.cwiseAbs() * S;
    for (Index i = 2; i < 29; ++i) {
        EXPECT_NEAR(first[i], 0, 1e-15 * terms[i]);  // three terms' rounding, in whatever order they are summed
        EXPECT_NEAR(second[i], -(0.04 + 0.05) * squares[i], 1e-9);
    }
    EXPECT_EQ(value_on_line(mesh, problem.u0, 95), 5);
    EXPECT_EQ(value_on_line(mesh, problem.u0, 300), 0);
}

TEST(AmericanPut, WithoutInterestIsHeldToTheEnd) {
    // Then the European value: strike (2 Phi(sigma/2) - 1) at the money.
    const auto [problem, mesh] = american_put(300, {.rate = 0});
    ContactWorkspace workspace(std::make_shared<AutomaticContact>());
    const auto march = integrate(Bdf2{}, problem, TimeGrid::until(1, 0.005), workspace);
    ASSERT_EQ(march.outcome, Outcome::converged);
    EXPECT_NEAR(value_on_line(mesh, march.final_state.u(), 100), 100 * std::erf(0.1 / std::sqrt(2.0)), 4e-3);
}

TEST(AmericanPut, RejectsBadInput) {
    EXPECT_THROW(american_put(1), InputError);
    EXPECT_THROW(american_put(9, {.strike = 0}), InputError);
    EXPECT_THROW(american_put(9, {.rate = -0.1}), InputError);
    EXPECT_THROW(american_put(9, {.volatility = 0}), InputError);
    EXPECT_THROW(american_put(9, {.highest = 100}), InputError);
}

}  // namespace
}  // namespace tact
