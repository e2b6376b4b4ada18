#include <gtest/gtest.h>

#include <sstream>

#include "../../contact/dense/dense_contact.hpp"
#include "../../tact.hpp"

namespace tact {
namespace {

ContactProblem oscillator() {
    ContactProblem p;
    p.M = Matrix::identity(1);
    p.K = Matrix::identity(1);
    p.B = Matrix::identity(1);
    p.c = Vector(Vector::Constant(1, -10));
    p.f = Vector(Vector::Zero(1));
    p.u0 = Vector::Ones(1);
    p.v0 = Vector::Zero(1);
    return p;
}

TEST(Door, SolvesByHand) {
    // Three masses on four springs under their own weight, the middle one on a floor: by symmetry 2 u + 1 = -1, and the
    // floor carries the rest of the balance of the middle one.
    ContactProblem p;
    p.K = Matrix(DenseMatrix{{2, -1, 0}, {-1, 2, -1}, {0, -1, 2}});
    p.B = Matrix(DenseMatrix{{0, 1, 0}});
    p.c = Vector(Vector::Constant(1, -1));
    p.f = Vector(Vector::Constant(3, -1));
    for (const Shared<ContactSolver>& contact : {Shared<ContactSolver>(), Shared<ContactSolver>(DenseContact())}) {
        const StaticSolution s = solve(p, contact);
        ASSERT_EQ(s.report.outcome, Outcome::converged);
        EXPECT_NEAR((s.u - Vector{{-1, -1, -1}}).norm(), 0, 1e-14);
        EXPECT_NEAR(s.lambda[0], 1, 1e-14);
    }
    p.c = Vector(Vector::Constant(1, std::nan("")));
    EXPECT_THROW((void)solve(p), InputError);
    EXPECT_THROW((void)solve(oscillator()), InputError);
}

TEST(Door, MarchesByTheTrapezoidUnlessToldOtherwise) {
    const TimeGrid grid = TimeGrid::until(1, 0.01);
    const March usual = march(oscillator(), {.grid = grid});
    ASSERT_EQ(usual.report.outcome, Outcome::converged);
    ASSERT_EQ(usual.u.rows(), 101);
    EXPECT_EQ(usual.v.rows(), 101);
    EXPECT_EQ(usual.lambda.rows(), 101);
    EXPECT_EQ(usual.times.size(), 101);
    EXPECT_EQ(usual.u(0, 0), 1);
    // The trapezoid rule turns (u, v) by 2 atan(h / 2) a step.
    for (Index k = 0; k <= 100; ++k) {
        EXPECT_EQ(usual.times[k], grid.t(k));
        EXPECT_NEAR(usual.u(k, 0), std::cos(2.0 * static_cast<double>(k) * std::atan(0.005)), 1e-12);
        EXPECT_NEAR(usual.v(k, 0), -std::sin(2.0 * static_cast<double>(k) * std::atan(0.005)), 1e-12);
    }
    EXPECT_TRUE(march(oscillator(), Scheme::named("trapezoid:e=0", grid)).u == usual.u);
    EXPECT_TRUE(march(oscillator(), {std::make_shared<Trapezoid>(), grid, std::make_shared<DenseContact>()}).u ==
                usual.u);
    EXPECT_FALSE(march(oscillator(), {Bdf2(), grid}).u == usual.u);
    EXPECT_THROW((void)march(oscillator(), {.grid = {0, 1}}), InputError);
    EXPECT_THROW((void)Scheme::named("trapezium", grid), InputError);
    EXPECT_THROW((void)Scheme::named("trapezoid", grid, "densee"), InputError);
}

TEST(Door, MarchesStaticProblemsByEquilibria) {
    ContactProblem p = oscillator();
    p.M.reset();
    p.v0 = {};
    p.f = {DenseMatrix{{1.0}}, [](double t, Side, VectorRef out) { out[0] = t; }};
    const March quasi = march(p, {.grid = {0.5, 4}});
    EXPECT_EQ(quasi.v.size(), 0);
    EXPECT_NEAR(quasi.u(4, 0), 2, 1e-14);
}

TEST(Door, KeepsTheSelectedStates) {
    const TimeGrid grid{0.01, 50};
    const March all = march(oscillator(), {.grid = grid});
    const auto kept = [&](const Keep& keep) {
        const March some = march(oscillator(), {.grid = grid}, {.keep = keep});
        EXPECT_EQ(some.times.size(), static_cast<Index>(some.steps.size()));
        for (std::size_t k = 0; k < some.steps.size(); ++k) {
            const Index row = static_cast<Index>(k);
            if (keep.u) {
                EXPECT_EQ(some.u(row, 0), all.u(some.steps[k], 0));
            }
            if (keep.v) {
                EXPECT_EQ(some.v(row, 0), all.v(some.steps[k], 0));
            }
            EXPECT_EQ(some.times[row], all.times[some.steps[k]]);
        }
        EXPECT_TRUE(some.report.final_state.y == all.report.final_state.y);
        return some.steps;
    };
    using Steps = std::vector<long>;
    EXPECT_EQ(kept({.stride = 20}), (Steps{0, 20, 40}));
    EXPECT_EQ(kept({.stride = 20, .initial = false}), (Steps{20, 40}));
    EXPECT_EQ(kept({.stride = 0, .steps = {50, 7, 7, 90}, .initial = false}), (Steps{7, 50}));
    EXPECT_EQ(kept({.stride = 0, .steps = {0, 3}, .initial = false}), (Steps{0, 3}));
    EXPECT_EQ(kept({.stride = 25, .steps = {25, 26}}), (Steps{0, 25, 26, 50}));
    EXPECT_EQ(kept({.stride = 0, .initial = false}), Steps{});
    EXPECT_EQ(kept({.stride = 50, .v = false, .lambda = false}), (Steps{0, 50}));
    EXPECT_EQ(march(oscillator(), {.grid = grid}, {.keep = {.u = false}}).u.size(), 0);
    EXPECT_THROW((void)kept({.stride = -1}), InputError);
    EXPECT_THROW((void)kept({.steps = {-1}}), InputError);
}

TEST(Door, KeepsAsManyStatesAsAnAdaptiveMarchHas) {
    long seen = 0;
    const March adaptive = march(oscillator(), Scheme::named("ida:rtol=1e-6", {1, 6}),
                                 {.observers = {[&](const State&, const StepReport&) {
                                      ++seen;
                                      return Flow::proceed;
                                  }}});
    ASSERT_EQ(adaptive.report.outcome, Outcome::converged);
    EXPECT_EQ(adaptive.u.rows(), seen);
    EXPECT_EQ(adaptive.u.rows(), adaptive.report.accepted_steps + 1);
    EXPECT_EQ(adaptive.times[seen - 1], 6);
    EXPECT_NEAR(adaptive.u(seen - 1, 0), std::cos(6.0), 1e-3);
}

TEST(Door, HandsBackTheStatesUpToTheStop) {
    const March stopped =
        march(oscillator(), {.grid = {0.01, 50}}, {.observers = {[](const State& state, const StepReport&) {
                                                       return state.step == 7 ? Flow::stop : Flow::proceed;
                                                   }}});
    EXPECT_EQ(stopped.report.outcome, Outcome::stopped);
    EXPECT_EQ(stopped.u.rows(), 8);
    EXPECT_EQ(stopped.times.size(), 8);
}

std::string printed(const auto& report) {
    std::ostringstream out;
    out << report;
    return out.str();
}
long lines(const std::string& text) { return 1 + std::count(text.begin(), text.end(), '\n'); }
bool holds(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

TEST(Reports, TakeOneLineWhenAllIsWell) {
    ContactProblem still = oscillator();
    still.M.reset();
    still.v0 = {};
    still.f = Vector(Vector::Constant(1, -20));
    const StaticSolution solution = solve(still);
    EXPECT_EQ(lines(printed(solution)), 1) << printed(solution);
    EXPECT_TRUE(holds(printed(solution.report), "converged: ")) << printed(solution.report);
    EXPECT_TRUE(holds(printed(solution.report), "1 row in contact, largest KKT residual"));

    ContactProblem falling = oscillator();
    falling.c = Vector(Vector::Constant(1, 0.5));
    const March bounces = march(falling, Scheme::named("trapezoid:e=1", {0.01, 300}));
    EXPECT_EQ(lines(printed(bounces)), 1) << printed(bounces);
    EXPECT_TRUE(
        holds(printed(bounces), "march of 301 kept states, converged: 300 steps to t = 3, contact from step "))
        << printed(bounces);
    EXPECT_EQ(lines(printed(bounces.report.last)), 1);
    EXPECT_TRUE(holds(printed(bounces.report.last), "step 300 to t = 3, converged: "))
        << printed(bounces.report.last);
}

TEST(Reports, SayWhatFailedAndWhatToTry) {
    // The floor at 1 and, from t = 0.5 on, a ceiling at 0.
    ContactProblem shut = oscillator();
    shut.B = Matrix(DenseMatrix{{1.0}, {-1.0}});
    shut.c = {DenseMatrix{{0, 1}, {-2, 2}}, [](double t, Side, VectorRef out) {
                  out[0] = 1;
                  out[1] = t < 0.495 ? 0 : 1;
              }};
    const March march = tact::march(shut, {.grid = {0.01, 100}});
    ASSERT_EQ(march.report.outcome, Outcome::infeasible);
    const std::string text = printed(march);
    EXPECT_TRUE(holds(text, "infeasible: 49 steps to t = 0.49")) << text;
    EXPECT_TRUE(holds(text, "step 50 to t = 0.5, infeasible")) << text;
    EXPECT_TRUE(holds(text, "tried: ")) << text;
    EXPECT_TRUE(holds(text, "rows that exclude each other, with their weights:")) << text;
    EXPECT_TRUE(holds(text, "try: ")) << text;

    ContactProblem floating = oscillator();
    floating.M.reset();
    floating.v0 = {};
    floating.K = Matrix(DenseMatrix{{1, -1}, {-1, 1}});
    floating.B = Matrix(DenseMatrix{{1.0, 0.0}});
    floating.f = Vector(Vector::Ones(2));
    floating.u0 = Vector::Zero(2);
    const StaticSolution lost = solve(floating);
    ASSERT_EQ(lost.report.outcome, Outcome::unbounded);
    EXPECT_TRUE(holds(printed(lost), "unknowns that move without limit")) << printed(lost);
    EXPECT_TRUE(holds(printed(lost), "try: ")) << printed(lost);

    const March tired = tact::march(oscillator(), Scheme::named("ida:most_steps=3", {1, 6}));
    ASSERT_EQ(tired.report.outcome, Outcome::step_limit);
    EXPECT_TRUE(holds(printed(tired), "try: a larger rtol")) << printed(tired);
}

TEST(Reports, ShowWarnings) {
    const March risky = march(oscillator(), Scheme::named("ida:order=5", {0.1, 1}));
    ASSERT_FALSE(risky.report.warning.empty());
    EXPECT_TRUE(holds(printed(risky), "\n  warning: ")) << printed(risky);
}

}  // namespace
}  // namespace tact
