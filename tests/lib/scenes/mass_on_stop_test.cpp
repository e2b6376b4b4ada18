#include "../../../lib/scenes/mass_on_stop.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "../../../contact/automatic.hpp"
#include "../../../integrators/sundials/bdf2.hpp"
#include "../../../lib/errors.hpp"

namespace tact {
namespace {

/// Small steps of free flight (kick, drift, kick) with the impact where u falls below zero, found to first order within the step.
BounceState stepped(const MassOnStopData& d, double e, double t_end, double dt) {
    BounceState s{d.height, d.velocity, 0, 0};
    const auto a = [&] { return -d.gravity - d.stiffness / d.mass * s.u; };
    for (long k = std::lround(t_end / dt); k > 0; --k) {
        s.v += dt / 2 * a();
        s.u += dt * s.v;
        s.v += dt / 2 * a();
        if (s.u < 0 && s.v < 0) {
            const double since = s.u / s.v, arrival = s.v - since * a();
            s.impulse -= d.mass * (1 + e) * arrival;
            s.v = -e * arrival + since * a();
            s.u = -e * arrival * since;
            ++s.impacts;
        }
    }
    return s;
}

TEST(MassOnStop, ExactTrajectoryIsThatOfSmallSteps) {
    const MassOnStopData cases[] = {{},
                                    {.mass = 2, .gravity = 9.81, .height = 0.5, .velocity = 3},
                                    {.gravity = 0, .stiffness = 4, .height = 0.3, .velocity = -1},
                                    {.mass = 3, .gravity = 2, .stiffness = 20, .height = 1, .velocity = 2},
                                    {.gravity = 1, .stiffness = 1e-9, .height = 1},
                                    {.gravity = 0, .height = 1, .velocity = -0.5}};
    for (const MassOnStopData& data : cases)
        for (const double e : {1.0, 0.8}) {
            const BounceState exact = bouncing_ball(data, e, 4), fine = stepped(data, e, 4, 1e-5);
            EXPECT_NEAR(exact.u, fine.u, 1e-6);
            EXPECT_NEAR(exact.v, fine.v, 1e-6);
            EXPECT_NEAR(exact.impulse, fine.impulse, 1e-6);
            EXPECT_EQ(exact.impacts, fine.impacts);
        }
}

TEST(MassOnStop, KnownTimes) {
    // Falls from 1 with g = 2 in one second, and for ever returns after two.
    const MassOnStopData data{.gravity = 2};
    EXPECT_NEAR(bouncing_ball(data, 1, 40).u, 1, 1e-13);
    EXPECT_EQ(bouncing_ball(data, 1, 39.5).impacts, 20);
    EXPECT_NEAR(bouncing_ball(data, 0.5, 1.25).u, 0.25 - 0.0625, 1e-15) << "speed 1 after the first impact";
    // The geometric sum 1 + 2 e/(1 - e) = 3 seconds of bounces; then the weight alone.
    EXPECT_GT(bouncing_ball(data, 0.5, 2.99).impacts, 5);
    const BounceState rest = bouncing_ball(data, 0.5, 5);
    EXPECT_EQ(rest.impacts, -1);
    EXPECT_EQ(rest.u, 0);
    EXPECT_EQ(rest.v, 0);
    EXPECT_NEAR(rest.impulse, 2 * 5, 1e-13) << "all the momentum the gravity gave";
    EXPECT_NEAR(bouncing_ball(data, 0, 5).impulse, 10, 1e-14);
    // On a spring half a period a bounce, whatever the speed.
    const MassOnStopData spring{.gravity = 0, .stiffness = 9, .height = 0.2};
    EXPECT_NEAR(bouncing_ball(spring, 0.5, std::numbers::pi / 3).u, 0.1, 1e-15);
    // It never falls.
    EXPECT_EQ(bouncing_ball({.gravity = 0, .velocity = 2}, 0.5, 7).u, 15);
    EXPECT_EQ(bouncing_ball({.gravity = 0, .height = 0}, 0.5, 7).u, 0);
}

TEST(MassOnStop, FineRunFallsAndHitsWhereTheExactOneDoes) {
    const MassOnStopData data{.gravity = 1, .stiffness = 3};
    const auto scene = mass_on_stop(data);
    validate(scene.problem);
    ContactWorkspace workspace(std::make_shared<AutomaticContact>());
    double worst = 0, impact = 0;
    const Observer observers[] = {[&](const State& state, const StepReport&) {
        if (state.lambda[0] > 0 && impact == 0) impact = state.t;
        if (impact == 0) worst = std::max(worst, std::abs(state.u()[0] - bouncing_ball(data, 1, state.t).u));
        return Flow::proceed;
    }};
    EXPECT_EQ(integrate(Bdf2{}, scene.problem, TimeGrid::until(2, 1e-4), workspace, observers).outcome,
              Outcome::converged);
    EXPECT_LT(worst, 1e-4);
    EXPECT_EQ(bouncing_ball(data, 1, impact - 2e-4).impacts, 0);
    EXPECT_EQ(bouncing_ball(data, 1, impact + 2e-4).impacts, 1);
}

TEST(MassOnStop, RejectsBadInput) {
    EXPECT_THROW(mass_on_stop({.mass = 0}), InputError);
    EXPECT_THROW(mass_on_stop({.gravity = -1}), InputError);
    EXPECT_THROW(mass_on_stop({.stiffness = -1}), InputError);
    EXPECT_THROW(mass_on_stop({.height = -1}), InputError);
    EXPECT_THROW(mass_on_stop({.velocity = std::nan("")}), InputError);
    EXPECT_THROW(bouncing_ball({}, 1.1, 1), InputError);
    EXPECT_THROW(bouncing_ball({}, 1, -1), InputError);
}

}  // namespace
}  // namespace tact
