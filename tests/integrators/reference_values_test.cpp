// The three scenes against values of an independent prototype (two solvers agreeing to the digits given). The full
// sizes are those of the paper; the quick ones were recorded from this code once it had reproduced the full ones.
#include <gtest/gtest.h>

#include <cmath>
#include <span>

#include "../../contact/automatic.hpp"
#include "../../integrators/sundials/bdf2.hpp"
#include "../../lib/scenes/membrane.hpp"
#include "../../lib/scenes/plates.hpp"
#include "../../lib/time/energy.hpp"

namespace tact {
namespace {

struct StaticReference {
    double gamma1, gamma2;
    Index active;
    double lowest, centre, right, energy;
};

void expect_static(Index n, std::span<const StaticReference> references) {
    ContactWorkspace workspace(std::make_shared<AutomaticContact>());
    const MembraneFamily family(n);
    for (const auto& r : references) {
        const auto p = family.at(Eigen::Vector2d(r.gamma1, r.gamma2));
        const auto s = solve_static(p, workspace);
        ASSERT_EQ(s.report.outcome, Outcome::converged);
        EXPECT_LE(s.report.kkt.largest(), 1e-10);
        EXPECT_EQ(s.report.active, r.active);
        EXPECT_NEAR(s.u.minCoeff(), r.lowest, 1e-12);
        EXPECT_NEAR(value_at(family.mesh(), s.u, .5, .5), r.centre, 1e-12);
        EXPECT_NEAR(value_at(family.mesh(), s.u, .7, .5), r.right, 1e-12);
        EXPECT_NEAR(0.5 * s.u.dot(p.K * s.u) - p.f.at(0).dot(s.u), r.energy, 1e-11);
    }
}

TEST(ReferenceValuesFullSize, StaticMembrane) {
    const StaticReference references[] = {
        {.45, .4, 34, -0.675306801208, -0.660116843095, -0.600580027753, -1.74492908241},
        {.33, .377, 18, -0.719066792999, -0.718527381211, -0.622501034646, -1.75422818814},
        {.6, .2, 34, -0.694007981192, -0.688805046915, -0.588286786857, -1.74730668526}};
    expect_static(200, references);
}

TEST(ReferenceValuesFullSize, StaticMembraneWithoutContact) {
    ContactProblem p = MembraneFamily(200).at(Eigen::Vector2d(.45, .4));
    p.c = Vector(Vector::Constant(p.size(), -infinity));
    ContactWorkspace workspace(std::make_shared<AutomaticContact>());
    const auto s = solve_static(p, workspace);
    ASSERT_EQ(s.report.outcome, Outcome::converged);
    EXPECT_EQ(s.report.active, 0);
    EXPECT_NEAR(s.u.minCoeff(), -0.736668225802, 1e-12);
    EXPECT_NEAR(0.5 * s.u.dot(p.K * s.u) - p.f.at(0).dot(s.u), -1.75707128446, 1e-11);
}

struct Probe {
    double t, x, y, value;
    std::size_t body;
};

/// Marches and compares the probes; returns the report.
MarchReport march(const ContactProblem& p, const Mesh& mesh, const TimeGrid& grid, std::span<const Probe> probes,
                  double tolerance, std::span<const std::pair<double, double>> energies = {}) {
    ContactWorkspace workspace(std::make_shared<AutomaticContact>());
    std::size_t compared = 0;
    const Observer observers[] = {[&](const State& s, const StepReport&) {
        for (const Probe& probe : probes)
            if (std::lround(probe.t / grid.dt) == s.step) {
                ++compared;
                EXPECT_NEAR(value_at(mesh, s.u(), probe.x, probe.y, probe.body), probe.value, tolerance)
                    << "t " << probe.t << " at " << probe.x << ", " << probe.y;
            }
        for (const auto& [t, value] : energies)
            if (std::lround(t / grid.dt) == s.step) {
                ++compared;
                EXPECT_NEAR(energy_of(p, s).total(), value, 1e-6);
            }
        return Flow::proceed;
    }};
    const auto report = integrate(Bdf2{}, p, grid, workspace, observers);
    EXPECT_EQ(report.outcome, Outcome::converged);
    EXPECT_EQ(compared, probes.size() + energies.size());
    EXPECT_LE(report.worst_kkt.largest(), 1e-10);
    return report;
}

TEST(ReferenceValuesFullSize, DynamicMembrane) {
    const MembraneFamily family(200, Motion::dynamic);
    const auto p = family.at(Eigen::Vector2d(.6, .6));
    const Probe probes[] = {{.5, .5, .5, -.81684777, 0},
                            {1, .5, .5, -.43274124, 0},
                            {.5, .25, .25, -.67968999, 0},
                            {1, .25, .25, -.13929367, 0}};
    const std::pair<double, double> energies[] = {{.5, -.238191}, {1, -.270849}};
    const auto report = march(p, family.mesh(), TimeGrid::until(2, .005), probes, 1e-7, energies);
    EXPECT_EQ(report.first_contact_step, 53);
    EXPECT_EQ(report.most_active, 1340);
}

TEST(ReferenceValuesFullSize, TwoPlates) {
    const auto [p, mesh] = two_plates(100);
    const Probe probes[] = {{.05, .5, .5, .0682799, 0}, {.05, .5, .5, .0874001, 1}, {.1, .5, .5, -.1092309, 0},
                            {.1, .5, .5, -.1114558, 1}, {.2, .5, .5, -.0965147, 0}, {.2, .5, .5, -.1291376, 1}};
    const auto report = march(p, mesh, TimeGrid::until(.4, 2e-4), probes, 1e-7);
    EXPECT_EQ(report.first_contact_step, 25);
    EXPECT_EQ(report.most_active, 370);
}

}  // namespace
}  // namespace tact
