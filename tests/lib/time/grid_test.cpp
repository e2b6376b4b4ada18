#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "../../../contact/dense/dense_contact.hpp"
#include "../../../integrators/trapezoid.hpp"
#include "../../../lib/scenes/mass_on_stop.hpp"
#include "../../../lib/time/integrator.hpp"

namespace tact {
namespace {

const double nan = std::numeric_limits<double>::quiet_NaN();

/// The text of the InputError that `action` must throw.
template <class Action> std::string refusal(const Action& action) {
    try {
        action();
    } catch (const InputError& error) {
        return error.what();
    }
    return "nothing was refused";
}

bool says(const std::string& text, const std::string& word) { return text.find(word) != std::string::npos; }

TEST(TimeGrid, RefusesWhatIsNoGridWithNumbersThatCanBeRead) {
    const std::string parts = refusal([] { (void)TimeGrid::until(1.05e-7, 1e-7); });
    EXPECT_TRUE(says(parts, "t_end is 1.05e-07") && says(parts, "dt = 1e-07") && says(parts, "whole number"))
        << parts;
    for (const auto& [t_end, dt] :
         {std::pair{1e300, 1e-300}, std::pair{infinity, 1.0}, std::pair{nan, 1.0}, std::pair{-1.0, 0.1},
          std::pair{1.0, nan}, std::pair{1.0, infinity}, std::pair{1e20, 1.0}}) {
        const auto [end, step] = std::pair(t_end, dt);
        const std::string text = refusal([&] { (void)TimeGrid::until(end, step); });
        EXPECT_TRUE(says(text, "TimeGrid: ")) << text;
    }
    EXPECT_EQ(TimeGrid::until(1e9, 1e-3).steps, 1000000000000);
    EXPECT_EQ(TimeGrid::until(0, 1e-3).steps, 0);
    EXPECT_EQ(TimeGrid::until(1e-9, 1e-12).steps, 1000);
}

/// Those that are accepted have points that differ: looked at one by one at both ends.
TEST(TimeGrid, AcceptsNoStepThatIsLostInRounding) {
    for (const double t0 : {0.0, 1.0, -3.0, 1e9, -1e9, 1e-300})
        for (int exponent = -330; exponent < 10; ++exponent) {
            const TimeGrid grid{std::pow(10.0, exponent) * 1.2345, 1000, t0};
            bool accepted = true;
            try {
                validate(grid);
            } catch (const InputError&) {
                accepted = false;
            }
            if (grid.dt > 1e-12 * std::abs(t0) && grid.dt > 1e-300) {
                EXPECT_TRUE(accepted) << grid.dt;
            }
            if (!accepted) continue;
            for (long n = 0; n < grid.steps; ++n) ASSERT_LT(grid.t(n), grid.t(n + 1)) << t0 << ' ' << grid.dt;
        }
}

TEST(TimeGrid, IsCheckedByIntegrate) {
    const ContactProblem problem = mass_on_stop().problem;
    ContactWorkspace workspace(std::make_shared<DenseContact>());
    const double lowest = -std::numeric_limits<double>::max();
    for (const TimeGrid& grid :
         {TimeGrid{.01, 10, nan}, TimeGrid{.01, 10, infinity}, TimeGrid{1e-10, 10, 1e9}, TimeGrid{nan, 10, 0},
          TimeGrid{.01, -1, 0}, TimeGrid{1e300, 10, lowest}, TimeGrid{1e308, 10, 0}})
        EXPECT_THROW((void)integrate(Trapezoid(), problem, grid, workspace), InputError)
            << grid.t0 << ' ' << grid.dt << ' ' << grid.steps;
}

TEST(SolveStatic, ChecksItsInputAndNamesTheEntry) {
    ContactProblem p;
    p.K = Matrix::identity(2);
    p.B = Matrix::identity(2);
    p.c = Vector(Vector::Zero(2));
    p.f = Vector(Vector::Zero(2));
    ContactWorkspace workspace(std::make_shared<DenseContact>());
    EXPECT_EQ(solve_static(p, workspace).report.outcome, Outcome::converged);
    for (const double bad : {nan, infinity}) {
        ContactProblem wrong = p;
        wrong.c.modes(1, 0) = bad;
        EXPECT_TRUE(says(refusal([&] { (void)solve_static(wrong, workspace); }), "c[1] is " + shown(bad)));
        wrong = p;
        wrong.f.modes(1, 0) = bad;
        EXPECT_TRUE(says(refusal([&] { (void)solve_static(wrong, workspace); }), "f[1] is " + shown(bad)));
        wrong = p;
        wrong.f.jumps = {0.5, bad};
        EXPECT_TRUE(says(refusal([&] { (void)solve_static(wrong, workspace); }), "f.jumps[1] is " + shown(bad)));
    }
    p.f.jumps = {0.5, 0.25};
    EXPECT_TRUE(says(refusal([&] { (void)solve_static(p, workspace); }), "f.jumps[1] is 0.25, expected at least"));
}

}  // namespace
}  // namespace tact
