#include "../../integrators/sundials/ida.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "../../contact/dense/dense_contact.hpp"
#include "../../integrators/quasi_static.hpp"
#include "../../integrators/sundials/arkode.hpp"
#include "../../integrators/trapezoid.hpp"
#include "../../lib/algebra/linear_solver.hpp"

namespace tact {
namespace {

ContactWorkspace dense_contact() { return ContactWorkspace(std::make_shared<DenseContact>()); }

/// u'' + u = 0, u(0) = 1; a stop at `stop` where one is wanted.
ContactProblem oscillator(std::optional<double> stop = {}) {
    ContactProblem p;
    p.M = Matrix::identity(1);
    p.K = Matrix::identity(1);
    p.B = stop ? Matrix::identity(1) : Matrix::without_rows(1);
    if (stop) p.c = Vector(Vector::Constant(1, *stop));
    p.f = Vector(Vector::Zero(1));
    p.u0 = Vector::Ones(1);
    p.v0 = Vector::Zero(1);
    return p;
}

std::vector<std::shared_ptr<const Integrator>> adaptive(double rtol, bool newton = false) {
    Ida::Options ida;
    ida.rtol = rtol;
    ida.atol = 1e-3 * rtol;
    ida.newton = newton;
    Arkode::Options arkode;
    arkode.rtol = rtol;
    arkode.atol = 1e-3 * rtol;
    arkode.newton = newton;
    return {std::make_shared<Ida>(ida), std::make_shared<Arkode>(sdirk2(), arkode),
            std::make_shared<Arkode>(tr_bdf2(), arkode), std::make_shared<Arkode>(esdirk32(), arkode),
            std::make_shared<Arkode>(sdirk54(), arkode)};
}

TEST(Ida, FixedStepsAreTheBdf2RecurrenceFromTheThirdStepOn) {
    // (3 y_n - 4 y_n-1 + y_n-2) / (2 dt) = y', with y' from the equation of motion, contact force included.
    ContactProblem p = oscillator(-0.5);
    p.K = scaled(9, p.K);
    const double dt = 0.01;
    auto workspace = dense_contact();
    const auto run = Ida::fixed_step().start(p, TimeGrid{dt, 300}, workspace);
    std::vector<State> states{run->state()};
    long contacts = 0;
    for (int n = 1; n <= 300; ++n) {
        const auto report = run->advance();
        ASSERT_EQ(report.outcome, Outcome::converged);
        EXPECT_EQ(run->state().t, n * dt);
        contacts += report.contact.active;
        states.push_back(run->state());
        if (n < 3) continue;
        const State &now = states[n], &last = states[n - 1], &second = states[n - 2];
        const Vector slope = (3 * now.y - 4 * last.y + second.y) / (2 * dt);
        EXPECT_NEAR(slope[0], now.v()[0], 4e-12 / dt) << n;
        EXPECT_NEAR(slope[1], now.lambda[0] - 9 * now.u()[0], 4e-12 / dt / dt) << n;
    }
    EXPECT_GT(contacts, 0);
}

TEST(Adaptive, TheErrorFollowsTheToleranceToTheExactOscillation) {
    for (std::size_t k = 0; k < 5; ++k) {
        double errors[3];
        for (int level = 0; level < 3; ++level) {
            const auto method = adaptive(std::pow(10.0, -3 - 2 * level))[k];
            auto workspace = dense_contact();
            const auto march = integrate(*method, oscillator(), TimeGrid{10, 1}, workspace);
            ASSERT_EQ(march.outcome, Outcome::converged) << method->name();
            EXPECT_EQ(march.final_state.t, 10);
            errors[level] = std::abs(march.final_state.u()[0] - std::cos(10.0));
        }
        EXPECT_LT(errors[2], 1e-3);
        EXPECT_LT(errors[1], errors[0] / 3) << k;
        EXPECT_LT(errors[2], errors[1] / 3) << k;
    }
}

TEST(Adaptive, SundialsNewtonAgreesWithTheStageHookWithoutContact) {
    for (std::size_t k = 0; k < 5; ++k) {
        auto workspace = dense_contact();
        ContactProblem p = oscillator();
        p.D = Matrix::diagonal(Vector::Constant(1, 0.3));
        const auto hook = integrate(*adaptive(1e-6)[k], p, TimeGrid{5, 1}, workspace);
        const auto method = adaptive(1e-6, true)[k];
        const auto newton = integrate(*method, p, TimeGrid{5, 1}, workspace);
        ASSERT_EQ(newton.outcome, Outcome::converged) << method->name();
        EXPECT_NEAR(newton.final_state.u()[0], hook.final_state.u()[0], 1e-4) << method->name();
        const auto with_stop = oscillator(-0.5);
        EXPECT_THROW((void)method->start(with_stop, TimeGrid{5, 1}, workspace), InputError);
    }
}

TEST(Adaptive, EveryStepThroughAnImpactIsAdmissibleAndCertified) {
    for (const auto& method : adaptive(1e-4)) {
        const auto p = oscillator(-0.5);
        auto workspace = dense_contact();
        double lowest = 0;
        const Observer observers[] = {[&](const State& state, const StepReport&) {
            lowest = std::min(lowest, state.u()[0]);
            return Flow::proceed;
        }};
        const auto march = integrate(*method, p, TimeGrid{20, 1}, workspace, observers);
        EXPECT_EQ(march.outcome, Outcome::converged) << method->name();
        EXPECT_GE(lowest, -0.5 - 1e-14);
        EXPECT_GT(march.first_contact_step, 0);
        EXPECT_LE(march.worst_kkt.largest(), 1e-12);
    }
}

TEST(Adaptive, DenseOutputAtRequestedTimesFollowsTheExactMotion) {
    std::vector<double> times;
    for (int k = 0; k <= 40; ++k) times.push_back(0.25 * k);
    for (const auto& method : adaptive(1e-7)) {
        auto workspace = dense_contact();
        std::size_t next = 0;
        double worst = 0;
        const auto march =
            integrate_with_output(*method, oscillator(), TimeGrid{10, 1}, workspace, times, [&](const State& state) {
                EXPECT_EQ(state.t, times[next++]);
                worst = std::max(worst, std::abs(state.u()[0] - std::cos(state.t)));
            });
        EXPECT_EQ(march.outcome, Outcome::converged);
        EXPECT_EQ(next, times.size());
        EXPECT_LT(worst, 1e-3) << method->name();
        const double backwards[] = {2, 1};
        EXPECT_THROW((void)integrate_with_output(*method, oscillator(), TimeGrid{10, 1}, workspace, backwards,
                                                 [](const State&) {}),
                     InputError);
    }
}

TEST(Adaptive, AnEventIsLocatedInTime) {
    // cos t passes zero at pi/2, and the gap to a stop at -1/2 closes at 2 pi/3: for adaptive and fixed steps.
    auto methods = adaptive(1e-8);
    methods.push_back(std::make_shared<Trapezoid>());
    for (const auto& method : methods) {
        const TimeGrid grid = method->adaptive() ? TimeGrid{10, 1} : TimeGrid{0.001, 10000};
        auto workspace = dense_contact();
        const auto passes =
            integrate_until(*method, oscillator(), grid, workspace, [](const State& state) { return state.u()[0]; });
        EXPECT_EQ(passes.outcome, Outcome::stopped);
        EXPECT_NEAR(passes.final_state.t, std::numbers::pi / 2, 1e-4) << method->name();
        const auto closes = integrate_until(*method, oscillator(-0.5), grid, workspace,
                                            [](const State& state) { return state.u()[0] + 0.5 - 1e-9; });
        EXPECT_NEAR(closes.final_state.t, 2 * std::numbers::pi / 3, 1e-3) << method->name();
        const auto never = integrate_until(*method, oscillator(), grid, workspace,
                                           [](const State& state) { return state.u()[0] + 2; });
        EXPECT_EQ(never.outcome, Outcome::converged);
    }
}

TEST(Adaptive, FailuresOfTheLibraryAreOutcomes) {
    auto workspace = dense_contact();
    const auto p = oscillator();
    Ida::Options ida;
    ida.rtol = 1e-30;
    ida.atol = 1e-30;
    EXPECT_EQ(integrate(Ida(ida), p, TimeGrid{10, 1}, workspace).outcome, Outcome::tolerance_too_small);
    ida = {};
    ida.most_steps = 3;
    const auto few = integrate(Ida(ida), p, TimeGrid{10, 1}, workspace);
    EXPECT_EQ(few.outcome, Outcome::step_limit);
    EXPECT_EQ(few.accepted_steps, 3);
    Arkode::Options arkode;
    arkode.most_steps = 3;
    EXPECT_EQ(integrate(Arkode(sdirk2(), arkode), p, TimeGrid{10, 1}, workspace).outcome, Outcome::step_limit);
    arkode.most_steps = 1000;
    arkode.rtol = 1e-30;
    arkode.atol = 1e-30;
    const auto fine = integrate(Arkode(sdirk2(), arkode), p, TimeGrid{10, 1}, workspace).outcome;
    EXPECT_TRUE(fine == Outcome::tolerance_too_small || fine == Outcome::step_too_small) << to_string(fine);
}

/// Throws from the third solve on.
class Failing final : public ContactSolver {
public:
    explicit Failing(bool fatal) : fatal_(fatal) {}
    std::unique_ptr<PreparedContact> prepare(const Matrix& A, const Matrix& B) const override {
        struct Prepared final : PreparedContact {
            ContactReport solve(const ConstVectorRef& b, const ConstVectorRef& c, ContactPoint point) override {
                if (++*count > 3) {
                    if (fatal) throw std::runtime_error("the solver room is on fire");
                    throw NumericalError("singular for a moment");
                }
                return inner->solve(b, c, point);
            }
            std::unique_ptr<PreparedContact> inner;
            std::shared_ptr<int> count;
            bool fatal = false;
        };
        auto prepared = std::make_unique<Prepared>();
        prepared->inner = DenseContact().prepare(A, B);
        prepared->count = count_;
        prepared->fatal = fatal_;
        return prepared;
    }

private:
    bool fatal_;
    std::shared_ptr<int> count_ = std::make_shared<int>(0);
};

TEST(Adaptive, WhatAHookThrowsComesBackWhole) {
    const auto p = oscillator();
    for (const bool newton : {false, true})
        for (std::size_t k = 0; k < 5; ++k) {
            const auto method = adaptive(1e-4, newton)[k];
            ContactWorkspace fatal(std::make_shared<Failing>(true));
            EXPECT_THROW((void)integrate(*method, p, TimeGrid{10, 1}, fatal), std::runtime_error) << method->name();
            // Recoverable to SUNDIALS' Newton: it shortens the step until it gives up, and the cause comes back.
            ContactWorkspace recoverable(std::make_shared<Failing>(false));
            EXPECT_THROW((void)integrate(*method, p, TimeGrid{10, 1}, recoverable), NumericalError) << method->name();
        }
}

TEST(Adaptive, BadOptionsAndTablesAreRejected) {
    Ida::Options ida;
    ida.rtol = 0;
    EXPECT_THROW(Ida{ida}, InputError);
    ida.rtol = -1;
    EXPECT_THROW(Ida{ida}, InputError);
    ida = {};
    ida.max_order = 6;
    EXPECT_THROW(Ida{ida}, InputError);
    Arkode::Options arkode;
    arkode.atol = 0;
    EXPECT_THROW(Arkode(sdirk2(), arkode), InputError);
    ButcherTable table = sdirk2();
    table.A(0, 1) = 0.1;
    EXPECT_THROW(Arkode{table}, InputError);
    table = sdirk2();
    table.c[0] = 0.7;
    EXPECT_THROW(Arkode{table}, InputError);
    table = sdirk2();
    table.b *= 2;
    EXPECT_THROW(Arkode{table}, InputError);
    table = sdirk2();
    table.b_embedded.resize(0);
    EXPECT_NO_THROW(Arkode{table});
    EXPECT_THROW(Arkode(table, Arkode::Options{}), InputError);
    // Implicit midpoint is not stiffly accurate: fine without contact only.
    table.A = DenseMatrix::Constant(1, 1, 0.5);
    table.b = Vector::Ones(1);
    table.c = Vector::Constant(1, 0.5);
    auto workspace = dense_contact();
    const auto free = oscillator(), stopped = oscillator(-0.5);
    EXPECT_NO_THROW((void)Arkode{table}.start(free, TimeGrid{0.1, 10}, workspace));
    EXPECT_THROW((void)Arkode{table}.start(stopped, TimeGrid{0.1, 10}, workspace), InputError);
}

TEST(Adaptive, OrdersAboveTwoWithContactAreWarnedOf) {
    Ida::Options ida;
    ida.max_order = 5;
    auto workspace = dense_contact();
    EXPECT_FALSE(integrate(Ida(ida), oscillator(-0.5), TimeGrid{1, 1}, workspace).warning.empty());
    EXPECT_TRUE(integrate(Ida(ida), oscillator(), TimeGrid{1, 1}, workspace).warning.empty());
    EXPECT_TRUE(integrate(Ida{}, oscillator(-0.5), TimeGrid{1, 1}, workspace).warning.empty());
}

}  // namespace
}  // namespace tact
