// Problems of other kinds through the same integrators: nonlinear, first order, quasi-static, floating.
#include <gtest/gtest.h>

#include <cmath>

#include "../../contact/automatic.hpp"
#include "../../contact/dense/dense_contact.hpp"
#include "../../integrators/bdf2_without_jump.hpp"
#include "../../integrators/quasi_static.hpp"
#include "../../integrators/sundials/arkode.hpp"
#include "../../integrators/sundials/bdf2.hpp"
#include "../../integrators/sundials/ida.hpp"
#include "../../integrators/trapezoid.hpp"
#include "../../lib/scenes/american_put.hpp"
#include "../../lib/scenes/duffing_membrane.hpp"
#include "../../lib/scenes/pressed_membrane.hpp"
#include "../../lib/time/energy.hpp"

namespace tact {
namespace {

ContactWorkspace dense_contact() { return ContactWorkspace(std::make_shared<DenseContact>()); }
ContactWorkspace automatic() { return ContactWorkspace(std::make_shared<AutomaticContact>()); }

Ida::Options fine_ida(bool newton) {
    Ida::Options options;
    options.rtol = 1e-8;
    options.atol = 1e-11;
    options.newton = newton;
    return options;
}

Arkode::Options fine_arkode(bool newton) {
    Arkode::Options options;
    options.rtol = 1e-8;
    options.atol = 1e-11;
    options.newton = newton;
    return options;
}

/// One load in three forms: dense modes, sparse ones, a function of its full size; and the gap moves in two of them.
TEST(Loads, OfEveryFormGiveTheSameMarch) {
    constexpr Index n = 12;
    DenseMatrix modes = DenseMatrix::Zero(n, 2);
    modes(4, 0) = -3;
    modes(7, 1) = 2;
    const auto swell = [](double t, Side, VectorRef out) { out << std::sin(9 * t), std::cos(5 * t); };
    const auto full = [modes](double t, Side, VectorRef out) {
        out.setZero();
        out[4] = std::sin(9 * t) * modes(4, 0);
        out[7] = std::cos(5 * t) * modes(7, 1);
    };
    ContactProblem p;
    p.M = Matrix::identity(n);
    DenseMatrix K = 2 * DenseMatrix::Identity(n, n);
    for (Index i = 1; i < n; ++i) K(i, i - 1) = K(i - 1, i) = -1;
    p.K = Matrix(DenseMatrix(50 * K));
    p.B = Matrix::identity(n);
    const auto lowered = [](double t, Side, VectorRef out) { out[0] = 1 + t; };
    const auto floor = [](double t, Side, VectorRef out) { out.setConstant(-0.02 * (1 + t)); };
    p.u0 = p.v0 = Vector::Zero(n);
    const Trapezoid trapezoid;
    const Ida ida(fine_ida(false));
    const Arkode arkode(sdirk2(), 0.5);
    for (const Integrator* method : std::initializer_list<const Integrator*>{&trapezoid, &ida, &arkode}) {
        Vector first;
        for (const int form : {0, 1, 2}) {
            p.f = form == 0   ? AffineVector(modes, swell)
                  : form == 1 ? AffineVector(SparseMatrix(modes.sparseView()), swell)
                              : AffineVector::function(n, full);
            p.c = form == 2 ? AffineVector::function(n, floor)
                            : AffineVector(DenseMatrix(DenseMatrix::Constant(n, 1, -0.02)), lowered);
            ContactWorkspace workspace = dense_contact();
            const MarchReport march = integrate(*method, p, TimeGrid::until(0.5, 0.01), workspace);
            ASSERT_EQ(march.outcome, Outcome::converged) << method->name();
            EXPECT_GT(march.first_contact_step, 0);
            if (form == 0) first = march.final_state.u();
            EXPECT_LE((march.final_state.u() - first).norm(), 1e-9) << method->name() << ' ' << form;
        }
    }
}

/// u'' + u + u^3 = 0, u(0) = 1.5.
ContactProblem duffing() {
    ContactProblem p;
    p.M = Matrix::identity(1);
    p.K = Matrix::identity(1);
    p.B = Matrix::without_rows(1);
    p.f = Vector(Vector::Zero(1));
    p.u0 = Vector::Constant(1, 1.5);
    p.v0 = Vector::Zero(1);
    p.r = InternalForce{[](const ConstVectorRef& u, VectorRef out) { out = u.array().cube(); },
                        [](const ConstVectorRef& u) { return Matrix::diagonal(3 * u.array().square()); },
                        [](const ConstVectorRef& u) { return u.array().square().square().sum() / 4; }};
    return p;
}

/// The classical Runge-Kutta method, written out.
double duffing_by_runge_kutta(double t_end) {
    constexpr int steps = 20000;
    const double h = t_end / steps;
    double u = 1.5, v = 0;
    const auto force = [](double x) { return -x - x * x * x; };
    for (int k = 0; k < steps; ++k) {
        const double u1 = v, v1 = force(u);
        const double u2 = v + h / 2 * v1, v2 = force(u + h / 2 * u1);
        const double u3 = v + h / 2 * v2, v3 = force(u + h / 2 * u2);
        const double u4 = v + h * v3, v4 = force(u + h * u3);
        u += h / 6 * (u1 + 2 * u2 + 2 * u3 + u4);
        v += h / 6 * (v1 + 2 * v2 + 2 * v3 + v4);
    }
    return u;
}

TEST(Nonlinear, DuffingsOscillatorFollowsRungeKuttaThroughEveryIntegrator) {
    const double exact = duffing_by_runge_kutta(3);
    const std::vector<std::pair<std::shared_ptr<const Integrator>, double>> methods{
        {std::make_shared<Bdf2>(), 2e-4},
        {std::make_shared<Trapezoid>(), 2e-4},
        {std::make_shared<Trapezoid>(Trapezoid::Options{0.5, 0}), 2e-4},
        {std::make_shared<Bdf2WithoutJump>(), 2e-4},
        {std::make_shared<Ida>(fine_ida(false)), 1e-4},
        {std::make_shared<Ida>(fine_ida(true)), 1e-4},
        {std::make_shared<Arkode>(sdirk54()), 1e-8},
        {std::make_shared<Arkode>(esdirk32(), fine_arkode(false)), 1e-5},
        {std::make_shared<Arkode>(esdirk32(), fine_arkode(true)), 1e-5}};
    for (const auto& [method, bound] : methods) {
        auto workspace = dense_contact();
        const auto march = integrate(*method, duffing(), TimeGrid::until(3, 0.0025), workspace);
        ASSERT_EQ(march.outcome, Outcome::converged) << method->name();
        EXPECT_NEAR(march.final_state.u()[0], exact, bound) << method->name();
    }
}

TEST(Nonlinear, ADuffingMembraneKeepsItsEnergyUntilContactTakesSome) {
    const Scene scene = duffing_membrane(15);
    auto workspace = automatic();
    EnergyLedger energy(scene.problem);
    const Observer observers[] = {energy.observer()};
    const auto march = integrate(Trapezoid{}, scene.problem, TimeGrid{0.002, 500}, workspace, observers);
    ASSERT_EQ(march.outcome, Outcome::converged);
    EXPECT_GT(march.first_contact_step, 10);
    EXPECT_LE(march.worst_kkt.largest(), 1e-10);
    double largest = 0;
    for (const Energy& e : energy.history()) {
        largest = std::max(largest, e.kinetic);
        if (e.t < static_cast<double>(march.first_contact_step - 1) * 0.002) {
            EXPECT_NEAR(e.total(), 0, 1e-4 * (e.strain + e.kinetic)) << e.t;
        }
    }
    EXPECT_LE(energy.history().back().total(), 1e-4 * largest);
}

TEST(FirstOrder, TheAmericanPutIsPricedByEveryIntegratorThatTakesIt) {
    // 6.0904; the grid's own error is .0034 at 300 cells (see tests/lib/scenes).
    const Scene scene = american_put(300);
    Ida::Options ida;
    ida.rtol = 1e-5;
    ida.atol = 1e-5;
    const std::vector<std::shared_ptr<const Integrator>> methods{
        std::make_shared<Bdf2>(), std::make_shared<Trapezoid>(), std::make_shared<Ida>(ida),
        std::make_shared<Arkode>(sdirk2())};
    for (const auto& method : methods) {
        auto workspace = automatic();
        const auto march = integrate(*method, scene.problem, TimeGrid::until(1, 0.01), workspace);
        ASSERT_EQ(march.outcome, Outcome::converged) << method->name();
        EXPECT_NEAR(value_on_line(scene.mesh, march.final_state.u(), 100), 6.0904, 0.01) << method->name();
        EXPECT_LE(march.worst_kkt.largest(), 1e-10) << method->name();
    }
}

TEST(QuasiStatic, EachStateOfAPressedMembraneIsItsEquilibrium) {
    const Scene scene = pressed_membrane(20);
    auto workspace = automatic();
    std::vector<State> states;
    const Observer observers[] = {[&](const State& state, const StepReport&) {
        states.push_back(state);
        return Flow::proceed;
    }};
    const TimeGrid grid{0.05, 20};
    const auto march = integrate(QuasiStatic{}, scene.problem, grid, workspace, observers);
    ASSERT_EQ(march.outcome, Outcome::converged);
    EXPECT_GT(march.most_active, 0);
    // Cold, at the time itself, with everything constant: another path through solve_static.
    for (const long step : {5L, 12L, 20L}) {
        ContactProblem at = scene.problem;
        at.c = Vector(scene.problem.c.at(grid.t(step)));
        at.f = Vector(scene.problem.f.at(grid.t(step)));
        auto other = automatic();
        const auto exact = solve_static(at, other);
        ASSERT_EQ(exact.report.outcome, Outcome::converged);
        const State& state = states[static_cast<std::size_t>(step)];
        EXPECT_LE((state.u() - exact.u).norm(), 1e-11 * (exact.u.norm() + 1e-12));
        EXPECT_LE((state.lambda - exact.lambda).norm(), 1e-9 * (exact.lambda.norm() + 1e-12));
    }
    EXPECT_THROW((void)QuasiStatic{}.start(duffing(), grid, workspace), InputError);
}

}  // namespace
}  // namespace tact
