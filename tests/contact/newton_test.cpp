// Stages with internal forces r(u): answers of other algorithms, tangents that are wrong, forces that are not finite.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>

#include "../../contact/automatic.hpp"
#include "../../integrators/trapezoid.hpp"
#include "../../lib/scenes/membrane.hpp"
#include "../../lib/time/stage.hpp"

namespace tact {
namespace {

ContactWorkspace automatic() { return ContactWorkspace(std::make_shared<AutomaticContact>()); }

/// r_i = k u_i^3, with a tangent that is `factor` times the derivative.
InternalForce cubic(double k, double factor = 1) {
    return {[k](const ConstVectorRef& u, VectorRef out) { out = k * u.array().cube(); },
            [k, factor](const ConstVectorRef& u) { return Matrix::diagonal(3 * factor * k * u.array().square()); },
            [k](const ConstVectorRef& u) { return k / 4 * u.array().square().square().sum(); }};
}

/// The largest of |f - K u - r(u) + B'lambda| over the largest of |f|, written out.
double true_residual(const ContactProblem& p, const Vector& u, const Vector& lambda) {
    Vector force(p.size()), pressed(p.size());
    p.r->force(u, force);
    p.B.multiply_transposed(lambda, pressed);
    const Vector f = p.f.at(0);
    return (f - p.K * u - force + pressed).lpNorm<Eigen::Infinity>() / f.lpNorm<Eigen::Infinity>();
}

ContactProblem one_spring(double K, InternalForce r, double f) {
    ContactProblem p;
    p.K = Matrix::diagonal(Vector::Constant(1, K));
    p.B = Matrix::without_rows(1);
    p.c = Vector(0);
    p.f = Vector(Vector::Constant(1, f));
    p.r = std::move(r);
    return p;
}

double by_bisection(const std::function<double(double)>& rising, double low, double high) {
    for (int k = 0; k < 200; ++k) {
        const double middle = 0.5 * (low + high);
        (rising(middle) < 0 ? low : high) = middle;
    }
    return low;
}

TEST(Newton, ACubicSpringAgreesWithBisection) {
    for (const double K : {1e-6, 1.0, 1e3})
        for (const double k : {1e-6, 1.0, 1e6})
            for (const double f : {1e-3, 5.0, 1e4}) {
                auto workspace = automatic();
                const auto solved = solve_static(one_spring(K, cubic(k), f), workspace);
                ASSERT_EQ(solved.report.outcome, Outcome::converged) << K << " " << k << " " << f;
                const double exact = by_bisection([&](double u) { return K * u + k * u * u * u - f; }, 0, f / K);
                EXPECT_NEAR(solved.u[0], exact, 1e-9 * exact) << K << " " << k << " " << f;
            }
}

TEST(Newton, AForceThatLevelsOffNeedsShorterSteps) {
    // K = 0.01: full Newton steps from u = 0 overshoot further and further.
    const InternalForce levels_off{
        [](const ConstVectorRef& u, VectorRef out) { out = u.array().atan(); },
        [](const ConstVectorRef& u) { return Matrix::diagonal((1 + u.array().square()).inverse()); }};
    auto workspace = automatic();
    for (const double f : {0.5, 1.2, 1.56, 1.7, 3.0}) {
        const auto solved = solve_static(one_spring(0.01, levels_off, f), workspace);
        ASSERT_EQ(solved.report.outcome, Outcome::converged) << f << " " << solved.report.detail;
        const double exact = by_bisection([&](double u) { return 0.01 * u + std::atan(u) - f; }, 0, 100 * f);
        EXPECT_NEAR(solved.u[0], exact, 1e-8 * exact) << f;
    }
}

TEST(Newton, ContactAgreesWithTheFixedPointOfContactSolvesWithK) {
    // The second algorithm: u <- argmin with K alone and the load f - r(u), a contraction where r' is below K.
    ContactProblem p = membrane(12, Eigen::Vector2d(0.5, 0.4)).problem;
    p.f = Vector(3 * p.f.at(0));
    p.r = cubic(0.002);
    auto workspace = automatic();
    const auto solved = solve_static(p, workspace);
    ASSERT_EQ(solved.report.outcome, Outcome::converged) << solved.report.detail;
    ASSERT_GT(solved.report.active, 0);
    const auto linear = AutomaticContact().prepare(p.K, p.B);
    Vector u = Vector::Zero(p.size()), lambda = Vector::Zero(p.constraints()), r(p.size());
    for (int k = 0; k < 300; ++k) {
        p.r->force(u, r);
        ASSERT_EQ(linear->solve(p.f.at(0) - r, p.c.at(0), {u, lambda}).outcome, Outcome::converged);
    }
    EXPECT_LE((solved.u - u).norm(), 1e-9 * u.norm());
    EXPECT_LE((solved.lambda - lambda).norm(), 1e-8 * lambda.norm());
    EXPECT_LE(true_residual(p, solved.u, solved.lambda), 1e-10);
}

TEST(Newton, AWrongTangentNeverChangesAnAnswer) {
    ContactProblem p = membrane(12, Eigen::Vector2d(0.5, 0.4)).problem;
    p.f = Vector(3 * p.f.at(0));
    p.r = cubic(0.002);
    auto workspace = automatic();
    const auto exact = solve_static(p, workspace);
    ASSERT_EQ(exact.report.outcome, Outcome::converged);
    int converged = 0;
    for (const double factor : {-1e10, -1.0, -0.1, 0.0, 0.5, 2.0, 10.0, 1e6, 1e10}) {
        p.r = cubic(0.002, factor);
        ContactProblem other = p;
        other.f = Vector(0.5 * p.f.at(0));
        for (const ContactProblem& problem : {p, other}) {
            auto fresh = automatic();
            const auto solved = solve_static(problem, fresh, &exact);
            if (solved.report.outcome == Outcome::converged) {
                ++converged;
                EXPECT_LE(true_residual(problem, solved.u, solved.lambda), 1e-9) << factor;
            } else {
                EXPECT_EQ(solved.u, exact.u) << factor;
                EXPECT_EQ(solved.lambda, exact.lambda) << factor;
                EXPECT_FALSE(solved.report.detail.empty()) << factor;
                EXPECT_GT(solved.report.kkt.largest(), 0) << factor;
            }
        }
    }
    EXPECT_GE(converged, 8);
}

TEST(Newton, TheCertificateIsThatOfTheStagesOwnEquations) {
    ContactProblem p = membrane(12, Eigen::Vector2d(0.5, 0.4)).problem;
    p.r = cubic(0.3);
    auto workspace = automatic();
    const auto solved = solve_static(p, workspace);
    ASSERT_EQ(solved.report.outcome, Outcome::converged);
    const Vector c = p.c.at(0);
    Vector r(p.size());
    p.r->force(solved.u, r);
    const auto kkt = KktCertificate(p.K, p.B)(p.f.at(0), RowBounds(c), solved.u, solved.lambda, r);
    EXPECT_EQ(solved.report.kkt.largest(), kkt.largest());
    // r counts in the scale by its size.
    const auto far = KktCertificate(p.K, p.B)(p.f.at(0), RowBounds(c), solved.u, solved.lambda, -r);
    EXPECT_GT(far.stationarity, 0.01);
}

TEST(Newton, AWeakForceMarchesAsManySolvesDoWithoutItAndFollowsIt) {
    ContactProblem linear = membrane(20, Eigen::Vector2d(0.5, 0.5), Motion::dynamic).problem, weak = linear;
    weak.r = cubic(1e-12);
    auto workspace = automatic();
    const TimeGrid grid{0.005, 100};
    const auto a = integrate(Trapezoid{}, linear, grid, workspace), b = integrate(Trapezoid{}, weak, grid, workspace);
    ASSERT_EQ(a.outcome, Outcome::converged);
    ASSERT_EQ(b.outcome, Outcome::converged);
    EXPECT_LE((a.final_state.u() - b.final_state.u()).norm(), 1e-6 * a.final_state.u().norm());
}

TEST(NotFinite, TheReportNamesWhatItIsWithTimeAndEntry) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    ContactProblem p = membrane(6, Eigen::Vector2d(0.5, 0.4)).problem;
    const Vector zero = Vector::Zero(p.size());
    const auto expect = [&](const ContactProblem& problem, const std::string& name, const std::string& entry) {
        auto workspace = automatic();
        StageSolver stages(problem, workspace);
        State state(problem);
        const State before = state;
        const auto report = stages.solve(Stage{0.25, 0, zero, zero}, state);
        EXPECT_EQ(report.outcome, Outcome::not_finite) << name;
        for (const auto& part : {name, entry, std::string("0.25")})
            EXPECT_NE(report.detail.find(part), std::string::npos) << report.detail;
        EXPECT_EQ(state.y, before.y);
        EXPECT_EQ(state.lambda, before.lambda);
    };
    const auto after = [&](double t) { return t > 0.2 ? nan : 1.0; };
    ContactProblem load = p, gap = p, force = p, tangent = p;
    load.f = AffineVector(p.f.modes, [&](double t, Side, VectorRef out) { out[0] = after(t); });
    expect(load, "f(t)", "entry 0");
    gap.c = AffineVector(p.c.modes, [&](double t, Side, VectorRef out) { out[0] = after(t); });
    expect(gap, "c(t)", "entry 0");
    force.r = InternalForce{[&](const ConstVectorRef&, VectorRef out) {
                                out.setZero();
                                out[7] = nan;
                            },
                            cubic(1).tangent};
    expect(force, "r(u)", "entry 7");
    tangent.r = InternalForce{
        cubic(1).force, [&](const ConstVectorRef& u) { return Matrix::diagonal(Vector::Constant(u.size(), nan)); }};
    expect(tangent, "tangent of r", "entry");
}

TEST(Indefinite, TheRefusalNamesTheMatrix) {
    const DenseMatrix saddle = (DenseMatrix(2, 2) << 1, 3, 3, 1).finished();
    const auto refusal = [](const ContactProblem& p) -> std::string {
        auto workspace = automatic();
        try {
            if (p.is_static()) return solve_static(p, workspace).report.detail;
            return integrate(Trapezoid{}, p, TimeGrid{0.1, 3}, workspace).last.contact.detail;
        } catch (const NumericalError& error) {
            return error.what();
        }
    };
    for (const bool rows : {false, true})
        for (const bool sparse : {false, true}) {
            ContactProblem p;
            p.K = sparse ? Matrix(Matrix(saddle).to_sparse()) : Matrix(saddle);
            p.B = rows ? Matrix::identity(2) : Matrix::without_rows(2);
            p.c = Vector(Vector::Constant(rows ? 2 : 0, -1));
            p.f = Vector(Vector::Ones(2));
            EXPECT_NE(refusal(p).find("K is indefinite"), std::string::npos) << refusal(p);
            p.u0 = p.v0 = Vector::Zero(2);
            p.M = Matrix::identity(2);
            p.K = scaled(1e4, p.K);
            EXPECT_NE(refusal(p).find("K is indefinite"), std::string::npos) << refusal(p);
            EXPECT_NE(refusal(p).find("dt"), std::string::npos) << refusal(p);
            p.K = Matrix::identity(2);
            p.M = scaled(1, Matrix(saddle));
            EXPECT_NE(refusal(p).find("M is indefinite"), std::string::npos) << refusal(p);
        }
}

}  // namespace
}  // namespace tact
