#include "../../integrators/sundials/bdf2.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "../../contact/automatic.hpp"
#include "../../contact/dense/dense_contact.hpp"
#include "../../contact/strategies/schur_contact.hpp"
#include "../../lib/algebra/linear_solver.hpp"
#include "../../lib/scenes/membrane.hpp"
#include "../../lib/time/energy.hpp"
#include "../../lib/time/trajectory.hpp"
#include "allocations.hpp"

namespace tact {
namespace {

/// u'' + 2 d u' + w^2 u = 0, u(0) = 1, u'(0) = 0.
ContactProblem oscillator(double w, double d = 0) {
    ContactProblem p;
    p.M = Matrix::identity(1);
    if (d > 0) p.D = Matrix::diagonal(Vector::Constant(1, 2 * d));
    p.K = Matrix::diagonal(Vector::Constant(1, w * w));
    p.B = Matrix::without_rows(1);
    p.f = Vector(Vector::Zero(1));
    p.u0 = Vector::Ones(1);
    p.v0 = Vector::Zero(1);
    return p;
}

ContactWorkspace no_contact() {
    return ContactWorkspace(std::make_shared<WithoutContact>(std::make_shared<DenseLinearSolver>()));
}

double error_at_one(double dt, double d) {
    const double w = 3;
    const auto p = oscillator(w, d);
    auto workspace = no_contact();
    const auto march = integrate(Bdf2{}, p, TimeGrid::until(1, dt), workspace);
    EXPECT_EQ(march.outcome, Outcome::converged);
    const double wd = std::sqrt(w * w - d * d);
    const double exact = std::exp(-d) * (std::cos(wd) + d / wd * std::sin(wd));
    return std::abs(march.final_state.u()[0] - exact);
}

TEST(Bdf2, ConvergesWithOrderTwoToTheExactOscillation) {
    for (const double d : {0.0, 0.4}) {
        const double order = std::log2(error_at_one(1e-3, d) / error_at_one(5e-4, d));
        EXPECT_NEAR(order, 2, 0.1) << "damping " << d;
    }
}

TEST(Bdf2, IsTheFormulaWrittenOutByHand) {
    const double w = 2, dt = 0.1;
    const auto p = oscillator(w);
    auto workspace = no_contact();
    const auto run = Bdf2{}.start(p, TimeGrid{dt, 5}, workspace);
    double u0 = 1, v0 = 0, u1 = 0, v1 = 0;
    for (int n = 1; n <= 5; ++n) {
        const double a = n == 1 ? 1 / dt : 1.5 / dt;
        const double bu = n == 1 ? -u0 / dt : (u0 - 4 * u1) / (2 * dt);
        const double bv = n == 1 ? -v0 / dt : (v0 - 4 * v1) / (2 * dt);
        const double u = -(bv + a * bu) / (a * a + w * w), v = a * u + bu;
        if (n > 1) u0 = u1, v0 = v1;
        u1 = u, v1 = v;
        const auto report = run->advance();
        ASSERT_EQ(report.outcome, Outcome::converged);
        EXPECT_NEAR(run->state().u()[0], u, 1e-14);
        EXPECT_NEAR(run->state().v()[0], v, 1e-13);
        EXPECT_EQ(run->state().t, n * dt);
    }
}

TEST(Bdf2, FirstOrderProblemsDecayWithOrderTwo) {
    const auto error = [](double dt) {
        ContactProblem p = oscillator(1);
        p.M.reset();
        p.D = Matrix::identity(1);
        p.v0.resize(0);
        auto workspace = no_contact();
        return std::abs(integrate(Bdf2{}, p, TimeGrid::until(1, dt), workspace).final_state.u()[0] - std::exp(-1));
    };
    EXPECT_NEAR(std::log2(error(1e-2) / error(5e-3)), 2, 0.1);
}

TEST(Bdf2, AMassComesToRestOnAStop) {
    // Gravity 1, stop at 0: the reaction must be the weight, to rounding, once all has settled.
    ContactProblem p = oscillator(0);
    p.K = Matrix::diagonal(Vector::Zero(1));
    p.B = Matrix::identity(1);
    p.c = Vector(Vector::Zero(1));
    p.f = Vector(Vector::Constant(1, -1.0));
    ContactWorkspace workspace(std::make_shared<DenseContact>());
    EnergyLedger energy(p);
    const Observer observers[] = {energy.observer()};
    const auto march = integrate(Bdf2{}, p, TimeGrid::until(40, 0.01), workspace, observers);
    EXPECT_EQ(march.outcome, Outcome::converged);
    EXPECT_NEAR(march.final_state.u()[0], 0, 1e-14);
    EXPECT_NEAR(march.final_state.lambda[0], 1, 1e-12);
    EXPECT_GT(march.first_contact_step, 140);
    EXPECT_LE(march.worst_kkt.largest(), 1e-14);
    // All of the energy m g h = 1 has gone into the scheme's impacts, none is created at rest.
    EXPECT_NEAR(energy.history().back().total(), 0, 1e-12);
}

#ifdef TACT_COUNTS_ALLOCATIONS
TEST(Bdf2, NothingIsAllocatedAfterTheSecondStep) {
    // Once the active sets have had their largest size: a second pass over the same steps allocates nothing at all.
    const MembraneFamily family(20, Motion::dynamic);
    const auto p = family.at(Eigen::Vector2d(0.5, 0.6));
    for (const auto& solver : {std::shared_ptr<const ContactSolver>(std::make_shared<AutomaticContact>()),
                               std::shared_ptr<const ContactSolver>(std::make_shared<SchurContact>()),
                               std::shared_ptr<const ContactSolver>(std::make_shared<DenseContact>())}) {
        ContactWorkspace workspace(solver);
        for (int pass = 0; pass < 2; ++pass) {
            const auto run = Bdf2{}.start(p, TimeGrid{0.005, 400}, workspace);
            long contacts = 0, before = 0;
            for (int n = 1; n <= 400; ++n) {
                if (n == 3) before = testing::allocations();
                const auto report = run->advance();
                ASSERT_EQ(report.outcome, Outcome::converged);
                contacts += report.contact.active > 0;
            }
            EXPECT_GT(contacts, 20);
            const long more = testing::allocations() - before;
            EXPECT_TRUE(pass == 0 || more == 0) << more << " allocations";
        }
    }
}
#endif

TEST(Bdf2, AFailedStepLeavesTheStateAndSaysWhere) {
    // The load turns to NaN at the third step.
    ContactProblem p = oscillator(1);
    p.f = AffineVector(DenseMatrix(DenseMatrix::Ones(1, 1)), [](double t, Side, VectorRef out) {
        out[0] = t > 0.25 ? std::numeric_limits<double>::quiet_NaN() : 0;
    });
    auto workspace = no_contact();
    const auto run = Bdf2{}.start(p, TimeGrid{0.1, 5}, workspace);
    ASSERT_EQ(run->advance().outcome, Outcome::converged);
    ASSERT_EQ(run->advance().outcome, Outcome::converged);
    const Vector before = run->state().y;
    const auto failed = run->advance();
    EXPECT_EQ(failed.outcome, Outcome::not_finite);
    EXPECT_EQ(failed.step, 3);
    EXPECT_EQ(run->state().y, before);
    EXPECT_EQ(run->state().step, 2);
    auto again = no_contact();
    const auto march = integrate(Bdf2{}, p, TimeGrid{0.1, 5}, again);
    EXPECT_EQ(march.outcome, Outcome::not_finite);
    EXPECT_EQ(march.accepted_steps, 2);
    EXPECT_EQ(march.last.step, 3);
}

TEST(Bdf2, AnExceptionInACoefficientFunctionComesBackWhole) {
    ContactProblem p = oscillator(1);
    p.f = AffineVector(DenseMatrix(DenseMatrix::Ones(1, 1)),
                       [](double, Side, VectorRef) { throw std::runtime_error("load cell unplugged"); });
    auto workspace = no_contact();
    const auto run = Bdf2{}.start(p, TimeGrid{0.1, 5}, workspace);
    EXPECT_THROW((void)run->advance(), std::runtime_error);
}

TEST(Bdf2, AnObserverStopsTheMarchAndSeesTheInitialState) {
    const auto p = oscillator(1);
    auto workspace = no_contact();
    std::vector<long> seen;
    const Observer observers[] = {[&](const State& s, const StepReport&) {
        seen.push_back(s.step);
        return s.step == 3 ? Flow::stop : Flow::proceed;
    }};
    const auto march = integrate(Bdf2{}, p, TimeGrid{0.1, 10}, workspace, observers);
    EXPECT_EQ(march.outcome, Outcome::stopped);
    EXPECT_EQ(seen, (std::vector<long>{0, 1, 2, 3}));
}

TEST(Bdf2, RejectsStaticProblemsAndBadGrids) {
    ContactProblem p = oscillator(1);
    p.M.reset();
    p.v0.resize(0);
    auto workspace = no_contact();
    EXPECT_THROW((void)Bdf2{}.start(p, TimeGrid{0.1, 5}, workspace), InputError);
    EXPECT_THROW((void)TimeGrid::until(1, 0), InputError);
    EXPECT_THROW((void)TimeGrid::until(1, -0.1), InputError);
    EXPECT_THROW((void)TimeGrid::until(1, 0.3), InputError);
    const auto good = oscillator(1);
    EXPECT_THROW((void)integrate(Bdf2{}, good, TimeGrid{0, 5}, workspace), InputError);
}

}  // namespace
}  // namespace tact
