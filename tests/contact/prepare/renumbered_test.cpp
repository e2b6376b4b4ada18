// The chooser on a random numbering against itself on the mesh's own, which it leaves as it is, and against the residuals of
// the caller's matrices.
#include "../../../contact/prepare/renumbered.hpp"

#include <gtest/gtest.h>

#include <numeric>
#include <random>

#include "../../../contact/automatic.hpp"
#include "../../../contact/strategies/schur_contact.hpp"
#include "../../../lib/sparse/cholmod_solver.hpp"

namespace tact {
namespace {

using Permutation = Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, long>;

struct Problem {
    SparseMatrix A, B;
    Vector b, c;
};

/// Springs between the nodes of a grid and to the ground, pressed down on one row a node at most.
Problem grid(Index n, double ground) {
    std::vector<Eigen::Triplet<double, long>> A;
    for (long i = 0; i < n * n; ++i) {
        A.emplace_back(i, i, 4 + ground);
        if (i % n > 0) A.emplace_back(i, i - 1, -1);
        if (i % n < n - 1) A.emplace_back(i, i + 1, -1);
        if (i >= n) A.emplace_back(i, i - n, -1);
        if (i < n * n - n) A.emplace_back(i, i + n, -1);
    }
    Problem p{SparseMatrix(n * n, n * n), SparseMatrix(n * n, n * n), Vector(n * n), Vector(n * n)};
    p.A.setFromTriplets(A.begin(), A.end());
    p.B.setIdentity();
    for (Index i = 0; i < n * n; ++i) {
        p.b[i] = -0.01 * static_cast<double>(1 + i % 7);
        p.c[i] = -0.05 - 0.002 * static_cast<double>(i % 11);
    }
    return p;
}

Permutation random_permutation(Index n, unsigned seed) {
    std::mt19937 random(seed);
    Permutation P(n);
    P.setIdentity();
    std::shuffle(P.indices().data(), P.indices().data() + n, random);
    return P;
}

SparseMatrix renumbered(const SparseMatrix& A, const Permutation& unknowns) {
    SparseMatrix result;
    result = A.twistedBy(unknowns);
    return result;
}

struct Solved {
    ContactReport report;
    Vector u, lambda;
};

Solved solve(const Problem& p, const Matrix& B, Index times = 1) {
    const Matrix A(p.A);
    const auto prepared = AutomaticContact().prepare(A, B);
    Solved s{{}, Vector::Zero(p.b.size()), Vector::Zero(p.c.size())};
    for (Index k = 0; k < times; ++k) s.report = prepared->solve(p.b, p.c, {s.u, s.lambda});
    return s;
}

void expect_same(const Problem& p) {
    const Permutation unknowns = random_permutation(p.A.rows(), 1), rows = random_permutation(p.B.rows(), 2);
    const Problem q{renumbered(p.A, unknowns), SparseMatrix(rows * p.B * unknowns.transpose()), unknowns * p.b,
                    rows * p.c};
    const Matrix B(q.B);
    const Solved a = solve(p, Matrix(p.B), 2), b = solve(q, B, 2);
    ASSERT_EQ(a.report.outcome, Outcome::converged);
    ASSERT_EQ(b.report.outcome, Outcome::converged);
    EXPECT_EQ(a.report.strategy, b.report.strategy);
    EXPECT_EQ(a.report.active, b.report.active);
    EXPECT_GT(b.report.active, 0);
    EXPECT_LE((unknowns * a.u - b.u).lpNorm<Eigen::Infinity>(), 1e-10 * a.u.lpNorm<Eigen::Infinity>());
    EXPECT_LE((rows * a.lambda - b.lambda).lpNorm<Eigen::Infinity>(), 1e-9 * a.lambda.lpNorm<Eigen::Infinity>());
    const auto kkt = kkt_residuals(Matrix(q.A), B, q.b, q.c, b.u, b.lambda);
    EXPECT_LE(kkt.largest(), 1e-12);
    EXPECT_NEAR(kkt.largest(), b.report.kkt.largest(), 1e-15);
}

TEST(Renumbered, BoundsAgreeWithTheMeshsOwnNumbering) {
    expect_same(grid(22, 0.1));   // sweeps
    expect_same(grid(22, 1e-3));  // multigrid
}

TEST(Renumbered, SomeBoundsAgreeWithTheMeshsOwnNumbering) {
    Problem p = grid(22, 1e-3);
    p.B = SparseMatrix(p.B.topRows(200));
    p.c = p.c.head(200).eval();
    expect_same(p);
}

TEST(Renumbered, PairsAndEmptyRowsAgreeWithTheMeshsOwnNumbering) {
    Problem p = grid(22, 0.1);
    std::vector<Eigen::Triplet<double, long>> B;
    for (long i = 0; i < 100; ++i) {
        B.emplace_back(i, 2 * i, 1);
        B.emplace_back(i, 2 * i + 201, -0.5);
    }
    p.B = SparseMatrix(101, p.A.rows());
    p.B.setFromTriplets(B.begin(), B.end());
    p.c = Vector::Constant(101, -0.02);
    expect_same(p);
}

TEST(Renumbered, EqualBodiesInContactAreNumberedAlike) {
    const Problem one = grid(22, 0.1);
    const Index n = one.A.rows();
    Problem p{SparseMatrix(2 * n, 2 * n), SparseMatrix(n, 2 * n), Vector(2 * n), one.c};
    std::vector<Eigen::Triplet<double, long>> A, B;
    for (long j = 0; j < n; ++j) {
        for (SparseMatrix::InnerIterator it(one.A, j); it; ++it)
            for (const long body : {0L, 1L}) A.emplace_back(body * n + it.row(), body * n + j, it.value());
        B.emplace_back(j, j, 1);
        B.emplace_back(j, n + j, -1);
    }
    p.A.setFromTriplets(A.begin(), A.end());
    p.B.setFromTriplets(B.begin(), B.end());
    p.b << one.b, -one.b;
    expect_same(p);

    const Permutation unknowns = random_permutation(2 * n, 1);
    Index blocks = 0;
    (void)prepare_renumbered(Matrix(renumbered(p.A, unknowns)), Matrix(SparseMatrix(p.B * unknowns.transpose())),
                             [&](const Matrix& ordered, const Matrix& rows) {
                                 blocks = identical_blocks(*ordered.sparse());
                                 return SchurContact().prepare(ordered, rows);
                             });
    EXPECT_EQ(blocks, 2);
}

TEST(Renumbered, ADiagonalOfRowsIsOneOfTheCallersUnknowns) {
    Problem p = grid(22, 1);
    const Permutation unknowns = random_permutation(p.A.rows(), 1);
    p.A = renumbered(p.A, unknowns);
    const Vector weight = Vector::LinSpaced(p.A.rows(), 0.5, 2);
    p.B = SparseMatrix(weight.asDiagonal());
    const Solved a = solve(p, Matrix(p.B)), b = solve(p, Matrix::diagonal(weight));
    ASSERT_EQ(a.report.outcome, Outcome::converged);
    ASSERT_EQ(b.report.outcome, Outcome::converged);
    EXPECT_EQ(a.u, b.u);
    EXPECT_EQ(a.lambda, b.lambda);
}

TEST(Renumbered, CertificatesComeInTheCallersNumbers) {
    Problem p = grid(22, 0.1);
    const Permutation unknowns = random_permutation(p.A.rows(), 1);
    p.A = renumbered(p.A, unknowns);
    p.B = SparseMatrix(3, p.A.rows());
    p.B.insert(0, 17) = 1;
    p.B.insert(1, 400) = 1;
    p.B.insert(2, 17) = -1;
    p.c = Vector{{1, -5, -0.5}};  // u_17 >= 1 and <= 0.5
    const Solved s = solve(p, Matrix(p.B));
    ASSERT_EQ(s.report.outcome, Outcome::infeasible);
    const Vector& y = s.report.infeasibility;
    ASSERT_EQ(y.size(), 3);
    EXPECT_GE(y.minCoeff(), 0);
    EXPECT_LE((p.B.transpose() * y).norm(), 1e-12);
    EXPECT_GT(p.c.dot(y), 0);
    EXPECT_EQ(s.u, Vector::Zero(p.A.rows()));

    Problem floating = grid(22, 0);
    floating.A = renumbered(floating.A, unknowns);
    // Rows sum to zero: a body that nothing holds, pulled up from its only stop.
    const Vector sums = floating.A * Vector::Ones(p.A.rows());
    floating.A.diagonal() -= sums;
    floating.b.setConstant(1);
    floating.B = SparseMatrix(1, p.A.rows());
    floating.B.insert(0, 3) = 1;
    floating.c = Vector{{0}};
    const Solved f = solve(floating, Matrix(floating.B));
    ASSERT_EQ(f.report.outcome, Outcome::unbounded);
    const Vector& d = f.report.ray;
    ASSERT_EQ(d.size(), p.A.rows());
    EXPECT_LE((floating.A * d).lpNorm<Eigen::Infinity>(), 1e-9);
    EXPECT_GT(floating.b.dot(d), 0);
}

}  // namespace
}  // namespace tact
