#include "../../../contact/strategies/multigrid_active_set.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "../../../contact/strategies/schur_contact.hpp"
#include "../../../lib/scenes/membrane.hpp"

namespace tact {
namespace {

struct Problem {
    Matrix A, B;
    Vector b, c;
};

Problem membrane_problem(Index n, double x, double height) {
    const auto problem = MembraneFamily(n).at(Eigen::Vector2d(x, height));
    return {problem.K, problem.B, problem.f.at(0), problem.c.at(0)};
}

/// In a random numbering, with coefficients that single precision does not hold and rows of any scale.
Problem shuffled(const Problem& p) {
    const Index n = p.A.rows();
    std::mt19937 random(3);
    Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, long> order(n);
    order.setIdentity();
    std::shuffle(order.indices().data(), order.indices().data() + n, random);
    Vector scale(n), row_scale(n);
    for (double& s : scale) s = 0.7 + 1e-3 * static_cast<double>(random() % 600);
    for (double& s : row_scale) s = std::exp(1e-2 * static_cast<double>(random() % 600));
    const SparseMatrix scaled = scale.asDiagonal() * *p.A.sparse() * scale.asDiagonal();
    SparseMatrix A;
    A = scaled.twistedBy(order);
    // u = scale v, a row of B for each v
    SparseMatrix B(n, n);
    const Vector bound = order * Vector(p.c.cwiseQuotient(scale));
    for (Index i = 0; i < n; ++i) B.insert(i, i) = row_scale[i];
    B.makeCompressed();
    return {Matrix(A), Matrix(B), order * Vector(p.b.cwiseProduct(scale)), bound.cwiseProduct(row_scale)};
}

/// Two rows an unknown: not below c, and not above a ceiling that the free membrane would not need but half of it hits.
Problem between_two_obstacles(Problem p) {
    const Index n = p.A.rows();
    SparseMatrix B(2 * n, n);
    Vector c(2 * n);
    for (Index i = 0; i < n; ++i) {
        B.insert(i, i) = 1;
        B.insert(n + i, i) = -2;
        c[i] = p.c[i];
        c[n + i] = i < n / 2 ? 0.4 : -infinity;  // u <= -0.2 on half of it
    }
    p.b.head(n / 2) *= 0.1;
    B.makeCompressed();
    return {p.A, Matrix(B), p.b, c};
}

void expect_agreement(const Problem& p) {
    const Index n = p.A.rows(), m = p.B.rows();
    Vector u = Vector::Zero(n), lambda = Vector::Zero(m), v = u, mu = lambda;
    const auto report = MultigridActiveSet().prepare(p.A, p.B)->solve(p.b, p.c, {u, lambda});
    const auto exact = SchurContact().prepare(p.A, p.B)->solve(p.b, p.c, {v, mu});
    ASSERT_EQ(report.outcome, Outcome::converged) << to_string(report.outcome);
    ASSERT_EQ(exact.outcome, Outcome::converged);
    EXPECT_LE(report.kkt.largest(), 1e-12);
    EXPECT_EQ(report.kkt.penetration, 0);
    EXPECT_GE(lambda.minCoeff(), 0);
    EXPECT_EQ(report.active, exact.active);
    EXPECT_LE((u - v).lpNorm<Eigen::Infinity>(), 1e-9 * v.lpNorm<Eigen::Infinity>());
    EXPECT_LE((lambda - mu).lpNorm<Eigen::Infinity>(), 1e-8 * mu.lpNorm<Eigen::Infinity>());
    const Vector gap = p.B * u - p.c;
    EXPECT_LE((lambda.array() > 0).select(gap.cwiseAbs(), 0).maxCoeff(), 1e-15 * v.lpNorm<Eigen::Infinity>() * 10);
}

TEST(MultigridActiveSet, AgreesWithTheSchurComplementOnMembranes) {
    for (const Index n : {5, 12, 40, 71})
        for (const double height : {0.2, 0.6}) expect_agreement(membrane_problem(n, 0.4, height));
}

TEST(MultigridActiveSet, AgreesInARandomNumberingWithRowsOfAnyScale) {
    for (const Index n : {12, 40, 71}) expect_agreement(shuffled(membrane_problem(n, 0.5, 0.3)));
}

TEST(MultigridActiveSet, AgreesBetweenTwoObstacles) {
    for (const Index n : {12, 40}) expect_agreement(between_two_obstacles(membrane_problem(n, 0.3, 0.5)));
}

TEST(MultigridActiveSet, AGuessShortensTheSolveAndDoesNotChangeIt) {
    const Problem p = membrane_problem(60, 0.45, 0.4);
    const auto prepared = MultigridActiveSet().prepare(p.A, p.B);
    ASSERT_TRUE(prepared->reads_guess());
    Vector u = Vector::Zero(p.A.rows()), lambda = u;
    const auto cold = prepared->solve(p.b, p.c, {u, lambda});
    const Vector first = u;
    const auto warm = prepared->solve(p.b, p.c, {u, lambda});
    ASSERT_EQ(warm.outcome, Outcome::converged);
    EXPECT_LT(warm.iterations, cold.iterations);
    EXPECT_LE((u - first).lpNorm<Eigen::Infinity>(), 1e-9);
    Vector far = Vector::Constant(p.A.rows(), -3), none = Vector::Zero(p.A.rows());
    ASSERT_EQ(prepared->solve(p.b, p.c, {far, none}).outcome, Outcome::converged);
    EXPECT_LE((far - first).lpNorm<Eigen::Infinity>(), 1e-9);
}

TEST(MultigridActiveSet, ASecondSolveIsTheSameAsAFirst) {
    const Problem p = membrane_problem(40, 0.35, 0.5), q = membrane_problem(40, 0.55, 0.3);
    const auto prepared = MultigridActiveSet().prepare(p.A, p.B);
    Vector u = Vector::Zero(p.A.rows()), lambda = u, v = u, mu = u;
    ASSERT_EQ(prepared->solve(p.b, p.c, {u, lambda}).outcome, Outcome::converged);
    u.setZero();
    ASSERT_EQ(prepared->solve(q.b, q.c, {u, lambda}).outcome, Outcome::converged);
    ASSERT_EQ(MultigridActiveSet().prepare(p.A, p.B)->solve(q.b, q.c, {v, mu}).outcome, Outcome::converged);
    EXPECT_EQ(u, v);
    EXPECT_EQ(lambda, mu);
}

TEST(MultigridActiveSet, WithoutRowsItIsALinearSolver) {
    const Problem p = membrane_problem(40, 0.35, 0.5);
    Vector u = Vector::Zero(p.A.rows()), lambda(0);
    const auto report =
        MultigridActiveSet().prepare(p.A, Matrix::without_rows(p.A.rows()))->solve(p.b, Vector(0), {u, lambda});
    ASSERT_EQ(report.outcome, Outcome::converged);
    EXPECT_LE(report.kkt.largest(), 1e-12);
}

TEST(MultigridActiveSet, BoundsThatExcludeEachOtherAreInfeasible) {
    Problem p = between_two_obstacles(membrane_problem(12, 0.3, 0.5));
    p.c[0] = 1;  // u_0 >= 1 and u_0 <= -0.2
    Vector u = Vector::Constant(p.A.rows(), 0.5), lambda = Vector::Zero(p.B.rows());
    EXPECT_EQ(MultigridActiveSet().prepare(p.A, p.B)->solve(p.b, p.c, {u, lambda}).outcome, Outcome::infeasible);
    EXPECT_EQ(u, Vector::Constant(p.A.rows(), 0.5));
}

TEST(MultigridActiveSet, RefusesWhatItCannotTake) {
    const Problem p = membrane_problem(5, 0.4, 0.2);
    SparseMatrix unsymmetric = *p.A.sparse(), pairs = p.B.to_sparse();
    unsymmetric.coeffRef(1, 0) = -0.5;
    pairs.coeffRef(2, 3) = 1;
    EXPECT_THROW((void)MultigridActiveSet().prepare(Matrix(unsymmetric), p.B), InputError);
    EXPECT_THROW((void)MultigridActiveSet().prepare(p.A, Matrix(pairs)), InputError);
    EXPECT_THROW((void)MultigridActiveSet().prepare(Matrix::identity(3), p.B), InputError);
}

}  // namespace
}  // namespace tact
