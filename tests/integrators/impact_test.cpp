// Laws of the schemes that keep the impact law apart from the position constraint.
#include <gtest/gtest.h>

#include <cmath>

#include "../../contact/automatic.hpp"
#include "../../contact/dense/dense_contact.hpp"
#include "../../integrators/bdf2_without_jump.hpp"
#include "../../integrators/central_difference.hpp"
#include "../../integrators/moreau_jean.hpp"
#include "../../integrators/sundials/arkode.hpp"
#include "../../integrators/sundials/bdf2.hpp"
#include "../../integrators/sundials/ida.hpp"
#include "../../integrators/trapezoid.hpp"
#include "../../lib/scenes/bar.hpp"
#include "../../lib/time/energy.hpp"
#include "../../lib/time/impact_ledger.hpp"
#include "random_systems.hpp"

namespace tact {
namespace {

ContactWorkspace dense_contact() { return ContactWorkspace(std::make_shared<DenseContact>()); }

/// A unit mass at height `height` above a rigid stop, thrown at -1.
ContactProblem thrown_mass(double height) {
    ContactProblem p;
    p.M = Matrix::identity(1);
    p.K = Matrix::diagonal(Vector::Zero(1));
    p.B = Matrix::identity(1);
    p.c = Vector(Vector::Zero(1));
    p.f = Vector(Vector::Zero(1));
    p.u0 = Vector::Constant(1, height);
    p.v0 = -Vector::Ones(1);
    return p;
}

std::vector<std::shared_ptr<const Integrator>> with_impact_law(double e) {
    return {std::make_shared<Trapezoid>(Trapezoid::Options{1, e}),
            std::make_shared<Trapezoid>(Trapezoid::Options{0.3, e}), std::make_shared<Bdf2WithoutJump>(e),
            std::make_shared<CentralDifference>(e)};
}

/// SUNDIALS' integrators with the same law.
std::vector<std::shared_ptr<const Integrator>> adaptive_with_impact_law(double e) {
    Ida::Options ida;
    ida.restitution = e;
    Arkode::Options arkode;
    arkode.restitution = e;
    std::vector<std::shared_ptr<const Integrator>> all{std::make_shared<Ida>(ida)};
    for (const ButcherTable& table : {sdirk2(), tr_bdf2(), esdirk32(), sdirk54()}) {
        all.push_back(std::make_shared<Arkode>(table, e));
        all.push_back(std::make_shared<Arkode>(table, arkode));
    }
    return all;
}

TEST(Impact, ASingleMassReboundsWithTheRestitutionThroughSundials) {
    // Exact, as below; without the law SDIRK 5(3)4 throws it back at up to twelve times its speed.
    for (const double e : {0.0, 0.4, 1.0})
        for (const auto& method : adaptive_with_impact_law(e))
            for (int phase = 0; phase < 40; ++phase) {
                const ContactProblem p = thrown_mass(1 + phase / 40.0 * 0.1);
                auto workspace = dense_contact();
                double impulse = 0, before = 0;
                const Observer observers[] = {[&](const State& state, const StepReport&) {
                    impulse += (state.t - before) * state.lambda[0];
                    before = state.t;
                    return Flow::proceed;
                }};
                const auto march = integrate(*method, p, TimeGrid{0.1, 30}, workspace, observers);
                ASSERT_EQ(march.outcome, Outcome::converged) << method->name();
                EXPECT_NEAR(march.final_state.v()[0], e, 1e-9) << method->name() << ", phase " << phase;
                EXPECT_NEAR(impulse, 1 + e, 1e-9) << method->name();
                EXPECT_GE(march.final_state.u()[0], -1e-14);
            }
}

TEST(Impact, ASingleMassReboundsWithTheRestitutionWhateverThePhase) {
    // Exact: it leaves with e. BDF2 with the position constraint alone: between .35 and 1.25.
    for (const double e : {0.0, 0.4, 1.0})
        for (const auto& method : with_impact_law(e))
            for (int phase = 0; phase < 40; ++phase) {
                const ContactProblem p = thrown_mass(1 + phase / 40.0 * 0.1);
                auto workspace = dense_contact();
                const auto march = integrate(*method, p, TimeGrid{0.1, 30}, workspace);
                ASSERT_EQ(march.outcome, Outcome::converged);
                EXPECT_NEAR(march.final_state.v()[0], e, 1e-12) << method->name() << ", phase " << phase;
                EXPECT_GE(march.final_state.u()[0], -1e-15);
            }
}

double energy(const ContactProblem& p, const State& state) { return energy_of(p, state).mechanical(); }

TEST(Impact, TrapezoidNeverGainsEnergyInTenThousandRandomStiffSystems) {
    // The theorem of docs/integrators.md, at every step; and no penetration.
    std::mt19937_64 random(1);
    double most = 0, deepest = 0, worst = 0;
    long impacts = 0;
    for (int k = 0; k < 10000; ++k) {
        const ContactProblem p = testing::random_stiff_system(random);
        auto workspace = dense_contact();
        const auto run = Trapezoid{}.start(p, TimeGrid{1, 20}, workspace);
        const double start = energy(p, run->state());
        double before = start;
        for (int n = 0; n < 20; ++n) {
            const StepReport report = run->advance();
            ASSERT_EQ(report.outcome, Outcome::converged)
                << k << " " << n << " " << report.contact.kkt.largest() << " impact "
                << (report.impact ? report.impact->kkt.largest() : 0);
            impacts += report.impact.has_value();
            const double now = energy(p, run->state());
            most = std::max(most, (now - before) / start);
            before = now;
            deepest = std::max(deepest, report.contact.kkt.penetration);
            worst = std::max({worst, report.contact.kkt.largest(), report.impact ? report.impact->kkt.largest() : 0});
        }
    }
    EXPECT_LE(most, 1e-11);
    EXPECT_LE(deepest, 1e-11);
    EXPECT_LE(worst, 1e-9);
    EXPECT_GT(impacts, 20000);
}

TEST(Impact, TheSafeguardKeepsEnergyForAnyRestitutionAndDamping) {
    // Steps that end in contact only: free steps of the damped family exchange kinetic for algorithmic energy.
    std::mt19937_64 random(2);
    for (int k = 0; k < 1000; ++k) {
        const ContactProblem p = testing::random_stiff_system(random);
        const double e = std::uniform_real_distribution<double>(0, 1)(random);
        auto workspace = dense_contact();
        const Trapezoid method({1, e});
        const auto run = method.start(p, TimeGrid{1, 20}, workspace);
        const double start = energy(p, run->state());
        double before = start;
        for (int n = 0; n < 20; ++n) {
            ASSERT_EQ(run->advance().outcome, Outcome::converged);
            const double now = energy(p, run->state());
            EXPECT_LE(now - before, 1e-11 * start) << k << " step " << n << " e " << e;
            before = now;
        }
    }
}

TEST(Impact, Bdf2WithoutJumpNeverExceedsTheEnergyItStartedWith) {
    // Bars of all stiffnesses, whose first period is up to 300 times shorter than a step or 70 times longer, and random
    // systems: energy may pass from motion to strain and back, but there is no load that could add any.
    std::mt19937_64 random(6);
    std::vector<std::pair<ContactProblem, TimeGrid>> cases;
    for (int k = -2; k <= 5; ++k)
        for (const double h : {0.0063, 0.01, 0.17, 0.7})
            cases.emplace_back(bar_impact(40, {.modulus = 900 * std::pow(10.0, k)}).problem, TimeGrid{h, 150});
    for (int k = 0; k < 1000; ++k) cases.emplace_back(testing::random_stiff_system(random), TimeGrid{1, 20});
    for (std::size_t k = 0; k < cases.size(); ++k) {
        const auto& [p, grid] = cases[k];
        const Bdf2WithoutJump method(0.5 * static_cast<double>(k % 3));
        ContactWorkspace workspace(std::make_shared<AutomaticContact>());
        const auto run = method.start(p, grid, workspace);
        const double start = energy(p, run->state());
        for (long n = 0; n < grid.steps; ++n) {
            ASSERT_EQ(run->advance().outcome, Outcome::converged) << k;
            EXPECT_LE(energy(p, run->state()), start * (1 + 1e-6)) << k << ", step " << n;  // u'K u rounds
        }
    }
}

TEST(Impact, Bdf2WithoutJumpIsBdf2InFreeFlight) {
    std::mt19937_64 random(3);
    for (int k = 0; k < 20; ++k) {
        ContactProblem p = testing::random_stiff_system(random);
        p.D = scaled(0.1, p.K);
        p.c = Vector(Vector::Constant(p.constraints(), -1e6));
        auto workspace = dense_contact();
        const TimeGrid grid{0.1, 30};
        const auto plain = integrate(Bdf2{}, p, grid, workspace);
        const auto without = integrate(Bdf2WithoutJump{}, p, grid, workspace);
        EXPECT_LE((plain.final_state.y - without.final_state.y).norm(), 1e-12 * plain.final_state.y.norm() + 1e-14);
    }
}

TEST(Impact, ABallComesToRestUnderItsWeight) {
    // lambda must become the weight, to rounding, for every scheme and restitution.
    for (const double e : {0.0, 0.5})
        for (const auto& method : with_impact_law(e)) {
            ContactProblem p = thrown_mass(1);
            p.f = Vector(-Vector::Ones(1));
            auto workspace = dense_contact();
            const auto march = integrate(*method, p, TimeGrid{0.01, 3000}, workspace);
            EXPECT_NEAR(march.final_state.lambda[0], 1, 1e-9) << method->name();
            EXPECT_NEAR(march.final_state.u()[0], 0, 1e-4) << method->name();
        }
}

TEST(Impact, MoreauJeanBouncesWithTheRestitution) {
    for (const double e : {0.0, 0.4, 1.0}) {
        auto workspace = dense_contact();
        const auto march = integrate(MoreauJean({0.5, e}), thrown_mass(1), TimeGrid{0.01, 200}, workspace);
        EXPECT_NEAR(march.final_state.v()[0], e, 1e-12);
    }
}

TEST(Impact, AMovingWallSetsTheVelocity) {
    // A wall that comes at speed 2 takes a mass at rest along (e = 0) or throws it at twice its speed (e = 1).
    for (const double e : {0.0, 1.0})
        for (const auto& method : with_impact_law(e)) {
            ContactProblem p = thrown_mass(0);
            p.v0.setZero();
            p.c = AffineVector(DenseMatrix(DenseMatrix::Ones(1, 1)),
                               [](double t, Side, VectorRef out) { out[0] = -1 + 2 * t; });
            auto workspace = dense_contact();
            const auto march = integrate(*method, p, TimeGrid{0.01, 100}, workspace);
            EXPECT_NEAR(march.final_state.v()[0], 2 * (1 + e), 1e-10) << method->name() << " " << e;
        }
}

TEST(Impact, TheLedgerSeesTheRestitutionAndTheEnergyLost) {
    // One impact at speed 1: (1 - e^2) / 2 is lost.
    for (const double e : {0.3, 1.0}) {
        const ContactProblem p = thrown_mass(1.03);
        ImpactLedger ledger(p);
        const Observer observers[] = {ledger.observer()};
        auto workspace = dense_contact();
        (void)integrate(Trapezoid({1, e}), p, TimeGrid{0.1, 30}, workspace, observers);
        EXPECT_EQ(ledger.summary().impacts, 1);
        EXPECT_NEAR(ledger.summary().restitution_min, e, 1e-12);
        EXPECT_NEAR(ledger.summary().restitution_max, e, 1e-12);
        EXPECT_NEAR(ledger.summary().energy_lost, 0.5 * (1 - e * e), 1e-12);
        EXPECT_LE(ledger.summary().energy_gained, 1e-12);
    }
}

TEST(Impact, RestitutionOutsideItsRangeIsRejected) {
    EXPECT_THROW(Trapezoid({1, -0.1}), InputError);
    EXPECT_THROW(Trapezoid({1, 1.1}), InputError);
    EXPECT_THROW(Trapezoid({1.5, 0}), InputError);
    EXPECT_THROW(Bdf2WithoutJump(2), InputError);
    EXPECT_THROW(MoreauJean({0.4, 0}), InputError);
}

}  // namespace
}  // namespace tact
