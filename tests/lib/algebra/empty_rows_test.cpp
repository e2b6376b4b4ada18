#include "../../../lib/algebra/empty_rows.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "../../../integrators/moreau_jean.hpp"
#include "../../../integrators/trapezoid.hpp"
#include "../../../lib/time/integrator.hpp"
#include "../../laws/strategies.hpp"

namespace tact {
namespace {

using laws::Rows;
using laws::strategies;
using laws::Strategy;

constexpr double one_rounding = 5.551115123125783e-17;  // of .1 + .2 - .3

/// min 1/2 |u|^2 - 3 u_1 - u_2 with u_1 + u_2 <= 1, by hand u = (3, 1) - 1.5 (1, 1), and row 0 without entries.
struct Programme {
    Matrix A = Matrix(DenseMatrix(DenseMatrix::Identity(2, 2)));
    Matrix B = Matrix(DenseMatrix{{0, 0}, {-1, -1}});
    Vector b = Vector{{3, 1}};
    Vector c(double first) const { return Vector{{first, -1}}; }
};

ContactReport solved(const ContactSolver& solver, const Matrix& A, const Matrix& B, const Vector& b, const Vector& c,
                     Vector& u, Vector& lambda) {
    u = Vector::Zero(A.rows());
    lambda = Vector::Zero(B.rows());
    return solver.prepare(A, B)->solve(b, c, {u, lambda});
}

class EmptyRows : public testing::TestWithParam<Strategy> {
protected:
    /// Rows of the kind the strategy takes: a bound u_1 <= 1 where it takes nothing else; by hand u = (1, 1), lambda = 2.
    bool general() const {
        const auto& takes = GetParam().takes;
        return std::find(takes.begin(), takes.end(), Rows::general) != takes.end();
    }
};

TEST_P(EmptyRows, AreOpenWhereTheirGapIsRounding) {
    const ContactSolver& solver = *GetParam().solver;
    const Programme programme;
    for (const bool sparse : {false, true}) {
        Matrix B = general() ? programme.B : Matrix(DenseMatrix{{0, 0}, {-1, 0}});
        if (sparse) B = Matrix(B.to_sparse());
        const Vector expected = general() ? Vector{{1.5, -0.5}} : Vector{{1, 1}};
        for (const double first : {one_rounding, 0.0, -0.25, -infinity}) {
            Vector u, lambda;
            const auto report = solved(solver, programme.A, B, programme.b, programme.c(first), u, lambda);
            ASSERT_EQ(report.outcome, Outcome::converged) << first << ' ' << to_string(report.outcome);
            EXPECT_LE((u - expected).norm(), 1e-9);
            EXPECT_EQ(lambda[0], 0);
            EXPECT_NEAR(lambda[1], general() ? 1.5 : 2, 1e-9);
        }
        for (const double first : {1e-9, 0.3, 1e300, infinity}) {
            Vector u, lambda;
            const auto report = solved(solver, programme.A, B, programme.b, programme.c(first), u, lambda);
            ASSERT_EQ(report.outcome, Outcome::infeasible) << first;
            EXPECT_EQ(report.infeasibility, Vector::Unit(2, 0));
            EXPECT_EQ(u, Vector::Zero(2)) << "a failed solve leaves the point";
            const std::string why = contradiction_of_empty_row(report, B, programme.c(first));
            EXPECT_NE(why.find("row 0 of B has no entries and c_0 is " + shown(first)), std::string::npos) << why;
        }
    }
}

/// What is rounding does not change with the units of u.
TEST_P(EmptyRows, AreJudgedAlikeInAllUnits) {
    const ContactSolver& solver = *GetParam().solver;
    const Programme programme;
    const Matrix B = general() ? programme.B : Matrix(DenseMatrix{{0, 0}, {-1, 0}});
    for (const double unit : {1e-60, 1e-9, 1e12, 1e60}) {
        Vector u, lambda;
        auto report = solved(solver, programme.A, B, unit * programme.b, unit * programme.c(one_rounding), u, lambda);
        EXPECT_EQ(report.outcome, Outcome::converged) << unit;
        report = solved(solver, programme.A, B, unit * programme.b, unit * programme.c(1e-6), u, lambda);
        EXPECT_EQ(report.outcome, Outcome::infeasible) << unit;
    }
}

TEST_P(EmptyRows, MayBeAllThereAre) {
    const ContactSolver& solver = *GetParam().solver;
    const Programme programme;
    const Matrix none = Matrix(SparseMatrix(2, 2));
    Vector u, lambda;
    auto report = solved(solver, programme.A, none, programme.b, Vector{{one_rounding, -1}}, u, lambda);
    ASSERT_EQ(report.outcome, Outcome::converged) << to_string(report.outcome);
    EXPECT_LE((u - programme.b).norm(), 1e-12);
    report = solved(solver, programme.A, none, programme.b, Vector{{one_rounding, 1e-3}}, u, lambda);
    EXPECT_EQ(report.outcome, Outcome::infeasible);
    EXPECT_EQ(report.infeasibility, Vector::Unit(2, 1));
}

INSTANTIATE_TEST_SUITE_P(All, EmptyRows, testing::ValuesIn(strategies()),
                         [](const auto& instance) { return std::string(instance.param.name); });

ContactProblem resting(double first, bool second_order) {
    const Programme programme;
    ContactProblem p;
    p.K = programme.A;
    if (second_order) p.M = Matrix::identity(2);
    p.B = programme.B;
    p.c = programme.c(first);
    p.f = Vector(programme.b);
    p.u0 = Vector{{1.5, -0.5}};
    if (second_order) p.v0 = Vector::Zero(2);
    return p;
}

std::string refusal(const std::function<void()>& action) {
    try {
        action();
    } catch (const InputError& error) {
        return error.what();
    }
    return {};
}

TEST(EmptyRowsOfAProblem, AreOpenOrNamedInStaticsAndInTime) {
    ContactWorkspace workspace(std::make_shared<AutomaticContact>());
    EXPECT_EQ(solve_static(resting(one_rounding, false), workspace).report.outcome, Outcome::converged);
    const std::string named = "row 0 of B has no entries and c_0 is 0.001";
    EXPECT_NE(refusal([&] { (void)solve_static(resting(1e-3, false), workspace); }).find(named), std::string::npos);
    const TimeGrid grid = TimeGrid::until(0.1, 0.01);
    for (const auto penetration :
         {InitialPenetration::reject, InitialPenetration::project, InitialPenetration::accept}) {
        const MarchOptions options{penetration};
        for (const bool at_rest_at_zero : {false, true})
            for (const Integrator* method : {static_cast<const Integrator*>(new Trapezoid()),
                                             static_cast<const Integrator*>(new MoreauJean())}) {
                const std::unique_ptr<const Integrator> owner(method);
                ContactProblem p = resting(one_rounding, true);
                if (at_rest_at_zero) p.u0.setZero();
                const MarchReport march = integrate(*method, p, grid, workspace, {}, options);
                EXPECT_EQ(march.outcome, Outcome::converged) << method->name() << ' ' << to_string(march.outcome);
            }
        const std::string text =
            refusal([&] { (void)integrate(Trapezoid(), resting(1e-3, true), grid, workspace, {}, options); });
        EXPECT_NE(text.find(named), std::string::npos) << text;
    }
}

}  // namespace
}  // namespace tact
