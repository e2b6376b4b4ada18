#include "../../../lib/scenes/string.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "../../../contact/automatic.hpp"
#include "../../../integrators/sundials/bdf2.hpp"
#include "../../../lib/errors.hpp"
#include "../../../lib/time/energy.hpp"

namespace tact {
namespace {

/// Velocity waves that move one cell a step, right and left, and scatter at the nodes: straight pieces are followed without
/// error, and so is an obstacle that they meet at whole steps. u at every node after each step, for wave speed 1 and cells of 1;
/// `obstacle` is the node that stays above zero.
std::vector<std::vector<double>> characteristics(std::vector<double> u, std::size_t obstacle, int steps) {
    const std::size_t cells = u.size() - 1;
    std::vector<double> right(cells), left(cells);
    for (std::size_t i = 0; i < cells; ++i) {
        left[i] = (u[i + 1] - u[i]) / 2;
        right[i] = -left[i];
    }
    std::vector<std::vector<double>> all{u};
    for (int k = 0; k < steps; ++k) {
        const std::vector<double> from_left = right, from_right = left;
        right[0] = -from_right[0];
        left[cells - 1] = -from_left[cells - 1];
        for (std::size_t node = 1; node < cells; ++node) {
            double v = from_left[node - 1] + from_right[node];
            if (node == obstacle) v = std::max(v, -u[node]);
            right[node] = v - from_right[node];
            left[node - 1] = v - from_left[node - 1];
            u[node] += v;
        }
        all.push_back(u);
    }
    return all;
}

std::vector<double> triangle(std::size_t elements, double pluck, double height) {
    std::vector<double> u(elements + 1);
    for (std::size_t i = 0; i <= elements; ++i) {
        const double s = double(i) / double(elements);
        u[i] = height * std::min(s / pluck, (1 - s) / (1 - pluck));
    }
    return u;
}

TEST(PluckedString, ExactMotionIsThatOfTheCharacteristics) {
    const PluckedStringData data{.length = 3, .tension = 8, .density = 2, .height = 0.2};
    const auto all = characteristics(triangle(60, 0.5, 0.2), 30, 300);
    const double step = 3.0 / 60 / 2;
    for (std::size_t k = 0; k < all.size(); ++k)
        for (std::size_t i = 0; i <= 60; ++i)
            ASSERT_NEAR(plucked_string_exact(data, 3 * double(i) / 60, double(k) * step).u, all[k][i], 1e-12);
    // Its period is 3/2 L/c, and 4 T height / L holds it in the middle third.
    EXPECT_NEAR(plucked_string_exact(data, 1, 0.3 + 2.25).u, plucked_string_exact(data, 1, 0.3).u, 1e-14);
    EXPECT_EQ(plucked_string_force(data, 0.74), 0);
    EXPECT_DOUBLE_EQ(plucked_string_force(data, 0.76), 4 * 8 * 0.2 / 3);
    EXPECT_EQ(plucked_string_force(data, 1.51), 0);
    const double jump = plucked_string_exact(data, 1.5001, 1).stress - plucked_string_exact(data, 1.4999, 1).stress;
    EXPECT_DOUBLE_EQ(jump, -plucked_string_force(data, 1));
    const double slope =
        (plucked_string_exact(data, 2.001, 0.1).u - plucked_string_exact(data, 1.999, 0.1).u) / 0.002;
    EXPECT_NEAR(plucked_string_exact(data, 2, 0.1).stress, 8 * slope, 1e-9);
    const double v = (plucked_string_exact(data, 1.5, 0.101).u - plucked_string_exact(data, 1.5, 0.099).u) / 0.002;
    EXPECT_NEAR(plucked_string_exact(data, 1.5, 0.1).v, v, 1e-9);
}

TEST(PluckedString, FineRunFollowsTheCharacteristicsAwayFromTheMiddle) {
    const PluckedStringData data{.pluck = 0.4, .obstacle = 0.25};
    const std::size_t cells = 400;
    const auto all = characteristics(triangle(cells, 0.4, 0.1), 100, 800);
    const auto scene = plucked_string(400, data);
    validate(scene.problem);
    EXPECT_NEAR(scene.problem.u0.maxCoeff(), 0.1, 1e-15);
    double worst = 0;
    ContactWorkspace workspace(std::make_shared<AutomaticContact>());
    const Observer observers[] = {[&](const State& state, const StepReport&) {
        if (state.step % 5 != 0) return Flow::proceed;
        const auto& exact = all[static_cast<std::size_t>(state.step / 5)];
        for (Index i = 0; i < state.n; ++i)
            worst = std::max(worst, std::abs(state.u()[i] - exact[static_cast<std::size_t>(i + 1)]));
        return Flow::proceed;
    }};
    const auto march = integrate(Bdf2{}, scene.problem, TimeGrid::until(2, 5e-4), workspace, observers);
    ASSERT_EQ(march.outcome, Outcome::converged);
    EXPECT_GT(march.first_contact_step, 0);
    EXPECT_LT(worst, 0.004) << "of 0.1";
}

TEST(DrapedString, RestIsInEquilibrium) {
    const DrapedStringData data{.length = 2, .tension = 3, .density = 2, .gravity = 5, .curvature = 4};
    const double s = 10.0 / (10 + 12), h = 1e-4;
    const auto u = [&](double x) { return draped_string_rest(data, x); };
    for (const double x : {-0.9, -0.5, 0.6, 0.99}) {
        EXPECT_NEAR(3 * (u(x + h) - 2 * u(x) + u(x - h)) / (h * h), 10, 1e-5) << "hangs free";
        EXPECT_GT(u(x), -2 * x * x);
    }
    EXPECT_NEAR(u(s - 1e-9), u(s + 1e-9), 1e-7);
    EXPECT_NEAR((u(s + h) - u(s)) / h, (u(s) - u(s - h)) / h, 1e-2) << "no kink";
    EXPECT_NEAR((u(1) - u(1 - h)) / h, 0, 1e-3) << "the end slides";
    EXPECT_DOUBLE_EQ(u(0.1), -2 * 0.01);
}

TEST(DrapedString, StaticSolveFindsTheRestThoughKIsSingular) {
    const DrapedStringData data;
    const auto error = [&](Index elements) {
        const auto scene = draped_string(elements, data, Motion::none);
        validate(scene.problem);
        EXPECT_NEAR((scene.problem.K * Vector::Ones(elements + 1)).norm(), 0, 1e-10);
        ContactWorkspace workspace(std::make_shared<AutomaticContact>());
        const auto rest = solve_static(scene.problem, workspace);
        EXPECT_EQ(rest.report.outcome, Outcome::converged);
        EXPECT_NEAR(rest.lambda.sum(), 1, 1e-9) << "the weight";
        double worst = 0;
        for (Index i = 0; i <= elements; ++i)
            worst = std::max(worst, std::abs(rest.u[i] - draped_string_rest(data, scene.mesh.bodies[0].line[i])));
        return worst;
    };
    EXPECT_LT(error(50), 2e-4);
    EXPECT_LT(error(400), 2e-4 / 64) << "second order";
}

TEST(DrapedString, FallsWithTheAccelerationOfGravityAndComesToRest) {
    const DrapedStringData data{.damping = 5};
    const auto scene = draped_string(60, data);
    validate(scene.problem);
    EXPECT_NEAR(scene.problem.M->main_diagonal().sum(), 1, 1e-14);
    ContactWorkspace workspace(std::make_shared<AutomaticContact>());
    double first = 0;
    const Observer observers[] = {[&](const State& state, const StepReport& report) {
        if (report.contact.active > 0 && first == 0) first = state.t;
        // u_tt + 5 u_t = -1 from rest.
        const double falling = 0.1 - state.t / 5 + (1 - std::exp(-5 * state.t)) / 25;
        EXPECT_TRUE(first > 0 || std::abs(state.u()[7] - falling) < 5e-4) << state.t;
        return Flow::proceed;
    }};
    const auto march = integrate(Bdf2{}, scene.problem, TimeGrid::until(20, 5e-3), workspace, observers);
    ASSERT_EQ(march.outcome, Outcome::converged);
    EXPECT_GT(first, 0.5);
    for (Index i = 0; i <= 60; ++i)
        EXPECT_NEAR(march.final_state.u()[i], draped_string_rest(data, scene.mesh.bodies[0].line[i]), 2e-4);
    EXPECT_NEAR(march.final_state.lambda.sum(), 1, 1e-6);
}

TEST(Strings, RejectBadInput) {
    EXPECT_THROW(plucked_string(1), InputError);
    EXPECT_THROW(plucked_string(7), InputError) << "no node in the middle";
    EXPECT_THROW(plucked_string(8, {.tension = 0}), InputError);
    EXPECT_THROW(plucked_string(8, {.pluck = 1}), InputError);
    EXPECT_THROW(plucked_string_exact({.pluck = 0.4}, 0, 0), InputError);
    EXPECT_THROW(plucked_string_force({.obstacle = 0.4}, 0), InputError);
    EXPECT_THROW(draped_string(0), InputError);
    EXPECT_THROW(draped_string(8, {.gravity = 0}), InputError);
    EXPECT_THROW(draped_string(8, {.damping = -1}), InputError);
}

}  // namespace
}  // namespace tact
