#include "../../../lib/scenes/bar.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

#include "../../../contact/automatic.hpp"
#include "../../../integrators/sundials/bdf2.hpp"
#include "../../../lib/errors.hpp"
#include "../../../lib/problem/mass_redistribution.hpp"
#include "../../../lib/time/energy.hpp"

namespace tact {
namespace {

// A continuous motion checked against the equation itself, by differences that share nothing with its formula.
struct Motion1D {
    std::function<BarState(double x, double t)> at;
    double density, modulus;
};

/// v = u_t, stress = E u_x, rho v_t = stress_x at points the waves miss by more than `step`; returns how many those were.
int expect_wave_equation(const Motion1D& motion, double from, double to, double t_end, double tolerance) {
    const double dx = 1e-5 * (to - from), dt = 1e-5 * t_end;
    int points = 0;
    for (int i = 1; i < 40; ++i)
        for (int k = 1; k < 60; ++k) {
            const double x = from + (to - from) * (i - 0.137) / 40, t = t_end * (k - 0.271) / 60;
            const BarState here = motion.at(x, t);
            const BarState before = motion.at(x, t - dt), after = motion.at(x, t + dt);
            const BarState left = motion.at(x - dx, t), right = motion.at(x + dx, t);
            const bool wave = before.v != after.v || left.stress != right.stress || left.v != right.v;
            if (wave) continue;
            ++points;
            EXPECT_NEAR((after.u - before.u) / (2 * dt), here.v, tolerance) << x << ", " << t;
            EXPECT_NEAR(motion.modulus * (right.u - left.u) / (2 * dx), here.stress, tolerance) << x << ", " << t;
        }
    return points;
}

/// Across every wave: u is continuous, and stress jumps by rho c times the jump of v.
void expect_jumps(const Motion1D& motion, double from, double to, double t_end, double tolerance) {
    const double Z = std::sqrt(motion.density * motion.modulus);
    for (int i = 1; i < 40; ++i) {
        const double x = from + (to - from) * (i - 0.137) / 40;
        BarState last = motion.at(x, 0);
        for (int k = 1; k <= 20000; ++k) {
            const BarState now = motion.at(x, t_end * k / 20000);
            EXPECT_NEAR(now.u, last.u,
                        1.01 * std::max(std::abs(now.v), std::abs(last.v)) * t_end / 20000 + tolerance);
            EXPECT_NEAR(std::abs(now.stress - last.stress), Z * std::abs(now.v - last.v), tolerance);
            last = now;
        }
    }
}

TEST(BarImpact, ExactMotionIsTheWaveEquations) {
    const BarImpactData data;
    const Motion1D motion{[&](double x, double t) { return bar_impact_exact(data, x, t); }, 1, 900};
    EXPECT_GT(expect_wave_equation(motion, 0, 10, 2, 1e-6), 2000);
    expect_jumps(motion, 0, 10, 2, 1e-9);
    const BarImpactData heavy{.length = 4, .density = 2, .modulus = 50, .velocity = -3, .gap = 1};
    const Motion1D other{[&](double x, double t) { return bar_impact_exact(heavy, x, t); }, 2, 50};
    EXPECT_GT(expect_wave_equation(other, 0, 4, 3, 1e-7), 2000);
    expect_jumps(other, 0, 4, 3, 1e-9);
    EXPECT_DOUBLE_EQ(bar_impact_force(heavy, 1), 30);
    for (const double t : {0.3, 0.7, 0.9, 1.1, 1.5}) {
        EXPECT_NEAR(bar_impact_exact(data, 10, t).stress, 0, 0) << "the far end is free";
        EXPECT_EQ(-bar_impact_exact(data, 0, t).stress, bar_impact_force(data, t));
    }
}

TEST(BarImpact, ExactNumbers) {
    const BarImpactData data;
    EXPECT_EQ(bar_impact_force(data, 0.4999), 0);
    EXPECT_DOUBLE_EQ(bar_impact_force(data, 0.5001), 300);
    EXPECT_DOUBLE_EQ(bar_impact_force(data, 1.1666), 300);
    EXPECT_EQ(bar_impact_force(data, 1.1667), 0);
    EXPECT_DOUBLE_EQ(bar_impact_exact(data, 4, 2).v, 10);
    EXPECT_NEAR(bar_impact_exact(data, 7, 1.5).u, 10 * (1.5 - 7.0 / 6), 1e-13);
}

struct Contact {
    double first = 0, last = 0, impulse = 0;
    MarchReport march;
};

Contact run(const ContactProblem& problem, double t_end, double dt) {
    Contact contact;
    ContactWorkspace workspace(std::make_shared<AutomaticContact>());
    const Observer observers[] = {[&](const State& state, const StepReport&) {
        contact.impulse += state.lambda.sum() * dt;
        if (state.lambda.sum() > 0)
            contact.first = contact.first == 0 ? state.t : contact.first, contact.last = state.t;
        return Flow::proceed;
    }};
    contact.march = integrate(Bdf2{}, problem, TimeGrid::until(t_end, dt), workspace, observers);
    return contact;
}

TEST(BarImpact, FineRunGoesToTheExactContact) {
    const BarImpactData data;
    for (const Mass mass : {Mass::lumped, Mass::consistent}) {
        const auto [problem, mesh] = bar_impact(400, data, mass);
        const Contact contact = run(problem, 1.5, 5e-4);
        ASSERT_EQ(contact.march.outcome, Outcome::converged);
        EXPECT_NEAR(contact.first, 0.5, 2e-3);
        EXPECT_NEAR(contact.last, 7.0 / 6, 0.02);
        EXPECT_NEAR(contact.impulse, 200, 1);
        EXPECT_NEAR(contact.march.final_state.v().mean(), 10, 0.1);
        Vector u(problem.size());
        for (Index i = 0; i < u.size(); ++i) u[i] = bar_impact_exact(data, mesh.bodies[0].line[i], 1.5).u;
        EXPECT_LT((contact.march.final_state.u() - u).cwiseAbs().maxCoeff(), 0.05);
    }
}

TEST(BarImpact, ErrorFallsOnRefinement) {
    const BarImpactData data;
    const auto error = [&](Index elements, double dt) {
        const auto [problem, mesh] = bar_impact(elements, data);
        double squares = 0, force = 0;
        ContactWorkspace workspace(std::make_shared<AutomaticContact>());
        const Observer observers[] = {[&, &line = mesh.bodies[0].line](const State& state, const StepReport&) {
            for (Index i = 0; i < state.n; ++i)
                squares +=
                    dt * std::pow(state.u()[i] - bar_impact_exact(data, line[i], state.t).u, 2) / double(elements);
            if (state.t > 0.6 && state.t < 1) force = std::max(force, std::abs(state.lambda[0] - 300));
            return Flow::proceed;
        }};
        EXPECT_EQ(integrate(Bdf2{}, problem, TimeGrid::until(1.5, dt), workspace, observers).outcome,
                  Outcome::converged);
        EXPECT_LT(force, 60);
        return std::sqrt(squares);
    };
    const double coarse = error(50, 4e-3), fine = error(200, 1e-3);
    EXPECT_LT(fine, coarse / 2);
    EXPECT_LT(fine, 0.02);
}

TEST(BarImpact, RedistributedMassTouchesOnceAndKeepsTheEnergy) {
    for (const double gap : {5.0, 4.9937, 4.9971}) {  // wherever in a step the impact falls
        const ContactProblem problem = redistribute_mass(bar_impact(100, {.gap = gap}).problem);
        ContactWorkspace workspace(std::make_shared<AutomaticContact>());
        EnergyLedger ledger(problem);
        int intervals = 0;
        bool touching = false;
        double impulse = 0, late = 0;
        const Observer observers[] = {ledger.observer(), [&](const State& state, const StepReport&) {
                                          const bool now = state.lambda[0] > 0;
                                          intervals += now && !touching;
                                          touching = now;
                                          impulse += 1e-3 * state.lambda[0];
                                          const double since = state.t - gap / 10;
                                          if (since > 0.1 && since < 0.55)
                                              late = std::max(late, std::abs(state.lambda[0] - 300));
                                          return Flow::proceed;
                                      }};
        const auto march = integrate(Bdf2{}, problem, TimeGrid::until(1.5, 1e-3), workspace, observers);
        ASSERT_EQ(march.outcome, Outcome::converged);
        EXPECT_EQ(intervals, 1);
        EXPECT_NEAR(impulse, 200, 2);
        EXPECT_LT(late, 30) << "the force is steady";
        EXPECT_NEAR(ledger.history().back().mechanical() / 500, 0.99, 0.015);
    }
}

TEST(BarImpact, GravityIsTheWeight) {
    const auto [problem, mesh] = bar_impact(20, {.velocity = 0, .gap = 1, .gravity = 10}, Mass::consistent);
    validate(problem);
    EXPECT_NEAR(problem.f.at(0).sum(), -100, 1e-12);
    EXPECT_NEAR((problem.K * Vector::Ones(21)).norm(), 0, 1e-11);
    const Contact contact = run(problem, 0.46, 1e-3);
    EXPECT_NEAR(contact.first, std::sqrt(0.2), 3e-3);
}

TEST(BouncingBar, ExactMotionIsTheWaveEquations) {
    const Motion1D motion{bouncing_bar_exact, 1, 1};
    EXPECT_GT(expect_wave_equation(motion, 0, 1, 6, 1e-9), 2000);
    expect_jumps(motion, 0, 1, 6, 1e-9);
    for (double t = 0.05; t < 6; t += 0.1) {
        EXPECT_EQ(bouncing_bar_exact(1, t).u, 0);
        EXPECT_GE(bouncing_bar_exact(0, t).u, 0);
        EXPECT_EQ(-bouncing_bar_exact(0, t).stress, t < 0.01 ? 0.5 : bouncing_bar_force(t));
        double energy = 0;
        for (int i = 0; i < 1000; ++i) {
            const BarState s = bouncing_bar_exact((i + 0.5) / 1000, t);
            energy += (s.v * s.v + s.stress * s.stress) / 2000;
        }
        EXPECT_NEAR(energy, 0.125, 1e-12);
    }
    EXPECT_EQ(bouncing_bar_exact(0.25, 0).u, 0.375);
    EXPECT_NEAR(bouncing_bar_exact(0.25, 4.4).u, bouncing_bar_exact(0.25, 1.4).u, 1e-15);
}

TEST(BouncingBar, FineRunFollowsTheExactMotion) {
    const auto scene = bouncing_bar(400);
    validate(scene.problem);
    EXPECT_NEAR(scene.problem.u0.dot(scene.problem.K * scene.problem.u0) / 2, 0.125, 1e-14);
    double worst = 0;
    ContactWorkspace workspace(std::make_shared<AutomaticContact>());
    const Observer observers[] = {[&](const State& state, const StepReport&) {
        for (const double x : {0.0, 0.3, 0.7})
            worst =
                std::max(worst, std::abs(value_on_line(scene.mesh, state.u(), x) - bouncing_bar_exact(x, state.t).u));
        return Flow::proceed;
    }};
    const auto march = integrate(Bdf2{}, scene.problem, TimeGrid::until(3, 1e-3), workspace, observers);
    ASSERT_EQ(march.outcome, Outcome::converged);
    EXPECT_LT(worst, 0.01);
}

TEST(TwoBars, EqualBarsSwapTheirVelocities) {
    const TwoBarsData data;
    const Motion1D left{[&](double x, double t) { return two_bars_exact(data, x, t, 0); }, 1, 900};
    const Motion1D right{[&](double x, double t) { return two_bars_exact(data, x, t, 1); }, 1, 900};
    EXPECT_GT(expect_wave_equation(left, -10, 0, 2, 1e-6), 2000);
    EXPECT_GT(expect_wave_equation(right, 0, 10, 2, 1e-6), 2000);
    expect_jumps(left, -10, 0, 2, 1e-9);
    EXPECT_DOUBLE_EQ(two_bars_force(data, 0.8), 150);
    EXPECT_NEAR(left.at(-3, 2).v, 0, 1e-14);
    EXPECT_NEAR(right.at(3, 2).v, 10, 1e-14);
    for (const double t : {0.2, 0.6, 0.9, 1.16, 1.7})
        EXPECT_NEAR(right.at(0, t).u - left.at(0, t).u + 5, t < 0.5 ? 5 - 10 * t : std::max(0.0, 10 * (t - 7.0 / 6)),
                    1e-12);
}

TEST(TwoBars, UnequalBarsLeaveAsTwoElasticBalls) {
    TwoBarsData data;
    data.left = {.length = 10, .density = 4, .modulus = 400, .velocity = 3};
    data.right = {.length = 20, .density = 1, .modulus = 400, .velocity = -2};
    data.gap = 1;
    const Motion1D left{[&](double x, double t) { return two_bars_exact(data, x, t, 0); }, 4, 400};
    const Motion1D right{[&](double x, double t) { return two_bars_exact(data, x, t, 1); }, 1, 400};
    EXPECT_GT(expect_wave_equation(left, -10, 0, 4, 1e-7), 2000);
    EXPECT_GT(expect_wave_equation(right, 0, 20, 4, 1e-7), 2000);
    expect_jumps(left, -10, 0, 4, 1e-9);
    expect_jumps(right, 0, 20, 4, 1e-9);
    for (const double t : {0.1, 0.7, 1.5, 2.1})
        EXPECT_NEAR(left.at(0, t).stress, right.at(0, t).stress, 1e-12) << "action and reaction";
    const double m1 = 40, m2 = 20;
    EXPECT_NEAR(two_bars_exact(data, -4, 9, 0).v, (m1 * 3 - m2 * 2 - m2 * 5) / (m1 + m2), 1e-13);
    EXPECT_NEAR(two_bars_exact(data, 4, 9, 1).v, (m1 * 3 - m2 * 2 + m1 * 5) / (m1 + m2), 1e-13);
    // Momentum: the force acts for 2 L/c.
    EXPECT_NEAR(two_bars_force(data, 1) * 2 * 10 / 10 / m2, two_bars_exact(data, 4, 9, 1).v + 2, 1e-12);
    EXPECT_DOUBLE_EQ(two_bars_exact(data, 0, 1, 0).v, two_bars_exact(data, 0, 1, 1).v);
}

TEST(TwoBars, FineRunFollowsTheExactMotion) {
    TwoBarsData data;
    data.left = {.length = 10, .density = 4, .modulus = 400, .velocity = 3, .elements = 200};
    data.right = {.length = 20, .density = 1, .modulus = 400, .velocity = -2, .elements = 250};
    data.gap = 1;
    const auto scene = two_bars(data);
    validate(scene.problem);
    const Contact contact = run(scene.problem, 3, 2e-3);
    ASSERT_EQ(contact.march.outcome, Outcome::converged);
    EXPECT_NEAR(contact.first, 0.2, 5e-3);
    EXPECT_NEAR(contact.last, 2.2, 0.05);
    const Index first = scene.mesh.bodies[1].first;
    const auto v = contact.march.final_state.v();
    EXPECT_NEAR(v.head(first).mean(), two_bars_exact(data, -4, 3, 0).v, 0.05);
    EXPECT_NEAR(v.tail(v.size() - first).mean(), two_bars_exact(data, 4, 3, 1).v, 0.05);
}

TEST(TwoBars, ExtremeRatiosGiveTheExactImpulses) {
    // Against a bar of impedance Z: v Z1 Z/(Z1 + Z) for 2 L/c. Against a rigid mass m the force dies as exp(-Z1 t/m).
    struct Ratio {
        double density, modulus, impulse;
    };
    for (const auto& [density, modulus, impulse] :
         {Ratio{1e6, 900, 200 / 1.001}, {1e6, 900e6, 200 / 1.000001}, {1, 900e9, 100 * (1 - std::exp(-2.0))}}) {
        TwoBarsData data;
        data.right = {.density = density, .modulus = modulus, .elements = 100};
        const auto scene = two_bars(data);
        const Contact contact = run(scene.problem, 2, 1e-3);
        ASSERT_EQ(contact.march.outcome, Outcome::converged) << density << ", " << modulus;
        EXPECT_NEAR(contact.impulse, impulse, 0.02 * impulse) << density << ", " << modulus;
        // What rounding of u does to the momentum through K in two seconds, and through v = (3/2 u + ...)/dt.
        const double rounding = 2e-16 * (200 * scene.problem.K.main_diagonal().maxCoeff() +
                                         1500 * 10 * scene.problem.M->main_diagonal().sum());
        const Vector momentum = scene.problem.M->main_diagonal().cwiseProduct(contact.march.final_state.v());
        EXPECT_NEAR(momentum.sum(), 100, rounding) << density << ", " << modulus;
    }
}

TEST(Bars, RejectBadInput) {
    EXPECT_THROW(bar_impact(0), InputError);
    EXPECT_THROW(bar_impact(5, {.density = 0}), InputError);
    EXPECT_THROW(bar_impact(5, {.gap = -1}), InputError);
    EXPECT_THROW(bar_impact(5, {.velocity = std::nan("")}), InputError);
    EXPECT_THROW(bar_impact_exact({.velocity = 1}, 0, 0), InputError);
    EXPECT_THROW(bar_impact_exact({.gravity = 1}, 0, 0), InputError);
    EXPECT_THROW(bouncing_bar(0), InputError);
    EXPECT_THROW(two_bars({.left = {.elements = 0}}), InputError);
    EXPECT_THROW(two_bars({.right = {.modulus = -1}}), InputError);
    EXPECT_THROW(two_bars_exact({.right = {.length = 5}}, 0, 0, 0), InputError);
    EXPECT_THROW(two_bars_exact({.left = {}, .right = {}}, 0, 0, 0), InputError) << "they never meet";
}

}  // namespace
}  // namespace tact
