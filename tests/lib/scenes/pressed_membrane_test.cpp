#include "../../../lib/scenes/pressed_membrane.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "../../../contact/automatic.hpp"
#include "../../../lib/errors.hpp"
#include "../../../lib/time/stage.hpp"

namespace tact {
namespace {

/// The equilibrium at one time.
State equilibrium(const ContactProblem& problem, ContactWorkspace& workspace, double t) {
    StageSolver stages(problem, workspace);
    State state(problem);
    const Vector zero = Vector::Zero(problem.size());
    EXPECT_EQ(stages.solve(Stage{t, 0, zero, Vector()}, state).outcome, Outcome::converged);
    return state;
}

double stamp(double x, double y, double t) {
    return 0.02 - 0.06 * (1 - std::cos(2 * std::numbers::pi * t)) + 2 * (std::pow(x - 0.5, 2) + std::pow(y - 0.5, 2));
}

/// Projected Gauss-Seidel on the five points, to the last digit.
Vector gauss_seidel(const Mesh& mesh, double t) {
    const Index n = mesh.n;
    Vector u = Vector::Zero(n * n);
    for (double change = 1; change > 1e-15;) {
        change = 0;
        for (Index k = 0; k < n * n; ++k) {
            const Index i = k % n, j = k / n;
            const double around = (i > 0 ? u[k - 1] : 0) + (i + 1 < n ? u[k + 1] : 0) + (j > 0 ? u[k - n] : 0) +
                                  (j + 1 < n ? u[k + n] : 0);
            const double next =
                std::min((around + 0.5 * t * mesh.h() * mesh.h()) / 4, stamp(mesh.x(k), mesh.y(k), t));
            change = std::max(change, std::abs(next - u[k]));
            u[k] = next;
        }
    }
    return u;
}

TEST(PressedMembrane, EquilibriaAreThoseOfGaussSeidel) {
    const auto [problem, mesh] = pressed_membrane(15);
    validate(problem);
    EXPECT_TRUE(problem.is_static());
    ContactWorkspace workspace(std::make_shared<AutomaticContact>());
    std::vector<Index> touching;
    for (const double t : {0.0, 0.1, 0.25, 0.5, 0.75, 1.0}) {
        const State state = equilibrium(problem, workspace, t);
        EXPECT_LT((state.u() - gauss_seidel(mesh, t)).cwiseAbs().maxCoeff(), 1e-12) << t;
        touching.push_back((state.lambda.array() > 0).count());
    }
    EXPECT_EQ(touching.front(), 0) << "clear of the stamp at first";
    EXPECT_GT(touching[3], 5);
}

TEST(PressedMembrane, ForceFollowsTheStampDownAndUp) {
    // The same depth on both ways; the more pressure from below, the more force.
    const auto with = pressed_membrane(21), without = pressed_membrane(21, {.pressure = 0});
    ContactWorkspace workspace(std::make_shared<AutomaticContact>(), 4);
    const auto force = [&](const Scene& scene, double t) {
        return equilibrium(scene.problem, workspace, t).lambda.sum();
    };
    EXPECT_NEAR(force(without, 0.3), force(without, 0.7), 1e-13);
    EXPECT_GT(force(without, 0.5), force(without, 0.3));
    EXPECT_GT(force(with, 0.3), force(without, 0.3));
    EXPECT_GT(force(with, 0.7), force(with, 0.3));
    EXPECT_EQ(force(without, 1), 0);
}

TEST(PressedMembrane, RejectsBadInput) {
    EXPECT_THROW(pressed_membrane(2), InputError);
    EXPECT_THROW(pressed_membrane(5, {.radius = 0}), InputError);
    EXPECT_THROW(pressed_membrane(5, {.clearance = -1}), InputError);
    EXPECT_THROW(pressed_membrane(5, {.pressure = std::nan("")}), InputError);
    EXPECT_THROW(pressed_membrane(5, {.duration = 0}), InputError);
}

}  // namespace
}  // namespace tact
