// Refinement against programmes of small integers, whose solutions are known without rounding.
#include "../../../contact/strategies/refined_contact.hpp"

#include <gtest/gtest.h>

#include "../../../contact/automatic.hpp"
#include "../../../contact/dense/dense_contact.hpp"
#include "../../../contact/strategies/multigrid_active_set.hpp"
#include "../../../contact/strategies/schur_contact.hpp"
#include "../../../lib/scenes/membrane.hpp"
#include "../../laws/quadratic_programs.hpp"
#include "../../laws/strategies.hpp"

namespace tact {
namespace {

/// Small integers everywhere, so that (u, lambda) solves it without any rounding: A = L L' with a random unit lower
/// triangle L, whose condition is far from small.
struct Planted {
    laws::QuadraticProgram qp;
    Vector u, lambda;
};
Planted planted(std::mt19937& random, Index n, Index m) {
    std::uniform_int_distribution<int> digit(-3, 3);
    const auto draw = [&](Index rows, Index cols) {
        return DenseMatrix::NullaryExpr(rows, cols, [&](Index, Index) { return static_cast<double>(digit(random)); })
            .eval();
    };
    Planted p;
    DenseMatrix L = draw(n, n).triangularView<Eigen::StrictlyLower>();
    L.diagonal().setOnes();
    p.qp.A = L * L.transpose();
    p.qp.B = draw(m, n);
    p.u = draw(n, 1);
    p.lambda = draw(m, 1).cwiseMax(0.0);
    p.qp.b = p.qp.A * p.u - p.qp.B.transpose() * p.lambda;
    p.qp.c = p.qp.B * p.u;
    for (Index i = 0; i < m; ++i)
        if (p.lambda[i] == 0) p.qp.c[i] -= 1;
    return p;
}

constexpr double epsilon = std::numeric_limits<double>::epsilon();

/// Relative, in max norms.
double error(const laws::Solved& s, const Planted& exact) {
    const auto of = [](const Vector& x, const Vector& y) {
        return (x - y).lpNorm<Eigen::Infinity>() / std::max(1.0, y.lpNorm<Eigen::Infinity>());
    };
    return std::max(of(s.u, exact.u), of(s.lambda, exact.lambda));
}

TEST(RefinedContact, IsExactToRoundingWhereTheInnerSolverLosesTheCondition) {
    std::mt19937 random(11);
    const auto inner = std::make_shared<AutomaticContact>();
    const RefinedContact refined(inner);
    double lost = 0;
    for (int k = 0; k < 300; ++k) {
        const Planted p = planted(random, 8, 4);
        const Matrix A(p.qp.A), B(p.qp.B);
        const laws::Solved plain = laws::solve(*inner, A, B, p.qp.b, p.qp.c, Vector::Zero(4));
        const laws::Solved better = laws::solve(refined, A, B, p.qp.b, p.qp.c, Vector::Zero(4));
        ASSERT_EQ(plain.report.outcome, Outcome::converged);
        ASSERT_EQ(better.report.outcome, Outcome::converged);
        ASSERT_LE(error(better, p), 4 * epsilon) << k;
        lost = std::max(lost, error(plain, p));
    }
    EXPECT_GE(lost, 1e-11) << "nothing to refine";
}

TEST(RefinedContact, BringsAnIterativeSolverToTheRoundingFloor) {
    const MembraneFamily family(40);
    const ContactProblem problem = family.at(Eigen::Vector2d(0.45, 0.4));
    const Vector zero = Vector::Zero(problem.c.size());
    const auto solve = [&](const ContactSolver& solver) {
        return laws::solve(solver, problem.K, problem.B, problem.f.at(0), problem.c.at(0), zero);
    };
    const auto inner = std::make_shared<MultigridActiveSet>();
    const laws::Solved plain = solve(*inner), better = solve(RefinedContact(inner)), direct = solve(SchurContact());
    ASSERT_EQ(better.report.outcome, Outcome::converged);
    EXPECT_LE(better.report.kkt.largest(), epsilon);
    EXPECT_LE(better.report.kkt.largest(), plain.report.kkt.largest());
    EXPECT_LE((better.u - direct.u).lpNorm<Eigen::Infinity>(), 1e-13 * direct.u.lpNorm<Eigen::Infinity>());
}

TEST(RefinedContact, DoesNotTradeALargeRowsRoundingForASmallRowsViolation) {
    // An A of two scales, one equality of 1e16 and one of 12, three times (found by fuzzing): no row is left further
    // violated, in its own size, than without refinement.
    const double large = 7498942093324558, small = 7.4989420933245583;
    laws::QuadraticProgram qp{
        DenseMatrix{{3.1622776601683789e+21, -4.7993232208983795e+17},
                    {-4.7993232208983795e+17, 5.62341325190349e+31}},
        DenseMatrix{{-large, -small}, {large, small}, {-12, -12}, {12, 12}, {-12, -12}, {12, 12}, {-12, -12}},
        Vector::Constant(2, -12), Vector{{-12, 12, -12, 12, -12, 12, -12}}};
    const auto inner = std::make_shared<AutomaticContact>();
    const auto violations = [&](const Vector& u) {
        const Vector size = qp.B.cwiseAbs() * u.cwiseAbs() + qp.c.cwiseAbs();
        return Vector((qp.c - qp.B * u).cwiseMax(0.0).cwiseQuotient(size));
    };
    const Matrix A(qp.A), B(qp.B);
    const Vector none = Vector::Zero(7);
    const laws::Solved plain = laws::solve(*inner, A, B, qp.b, qp.c, none),
                       refined = laws::solve(RefinedContact(inner), A, B, qp.b, qp.c, none);
    ASSERT_EQ(refined.report.outcome, plain.report.outcome);
    const Vector before = violations(plain.u), after = violations(refined.u);
    for (Index i = 0; i < 7; ++i) EXPECT_LE(after[i], std::max(before[i], 1e-12)) << "row " << i;
}

TEST(RefinedContact, LeavesAnInfeasibleProgrammeItsCertificate) {
    const Matrix A = Matrix::identity(1), B(DenseMatrix{{1.0}, {-1.0}});
    const laws::Solved s = laws::solve(RefinedContact(std::make_shared<DenseContact>()), A, B, Vector::Zero(1),
                                       Vector::Ones(2), Vector::Zero(2));
    EXPECT_EQ(s.report.outcome, Outcome::infeasible);
    EXPECT_EQ(s.report.infeasibility.size(), 2);
}

}  // namespace
}  // namespace tact
