#include "../../../contact/strategies/diagonal_contact.hpp"

#include <gtest/gtest.h>

#include <random>

#include "../../../contact/automatic.hpp"
#include "../../../contact/strategies/schur_contact.hpp"

namespace tact {
namespace {

TEST(DiagonalContact, AgreesWithTheSchurComplementOnPairsAndBounds) {
    std::mt19937 random(5);
    std::normal_distribution<double> normal;
    for (const bool pairs : {false, true})
        for (int k = 0; k < 50; ++k) {
            const Index m = 30, n = 2 * m + 3;
            const Vector d = Vector::NullaryExpr(n, [&] { return std::exp(3 * normal(random)); });
            SparseMatrix B(m, n);
            for (Index i = 0; i < m; ++i) {
                B.insert(i, i) = normal(random) + 3;
                if (pairs) B.insert(i, m + i) = normal(random) - 3;
            }
            const Matrix A = Matrix::diagonal(d), rows{B};
            const Vector b = Vector::NullaryExpr(n, [&] { return normal(random); });
            Vector c = Vector::NullaryExpr(m, [&] { return normal(random); });
            c[k % m] = -infinity;
            Vector u = Vector::Zero(n), lambda = Vector::Zero(m), other_u = u, other_lambda = lambda;
            const auto report = DiagonalContact().prepare(A, rows)->solve(b, c, {u, lambda});
            ASSERT_EQ(report.outcome, Outcome::converged);
            EXPECT_LE(report.kkt.largest(), 1e-13);
            const auto sparse = Matrix(A.to_sparse());
            ASSERT_EQ(SchurContact().prepare(sparse, rows)->solve(b, c, {other_u, other_lambda}).outcome,
                      Outcome::converged);
            EXPECT_LE((u - other_u).norm(), 1e-12 * u.norm());
            EXPECT_LE((lambda - other_lambda).norm(), 1e-10 * lambda.norm());
        }
}

TEST(DiagonalContact, IsWhatTheChooserTakesAndRejectsTheRest) {
    const Matrix A = Matrix::identity(3);
    const auto pairs = Matrix(DenseMatrix{{1, -1, 0}});
    Vector u = Vector::Zero(3), lambda = Vector::Zero(1);
    const Vector b = Vector::Zero(3), c = Vector::Ones(1);
    EXPECT_EQ(AutomaticContact().prepare(A, pairs)->solve(b, c, {u, lambda}).strategy, "row by row");
    const auto overlapping = Matrix(DenseMatrix{{1, -1, 0}, {0, 1, 1}});
    EXPECT_THROW((void)DiagonalContact().prepare(A, overlapping), InputError);
    EXPECT_THROW((void)DiagonalContact().prepare(Matrix(DenseMatrix(DenseMatrix::Identity(3, 3))), pairs),
                 InputError);
    EXPECT_THROW((void)DiagonalContact().prepare(Matrix::diagonal(Vector{{1, -1, 1}}), pairs), InputError);
}

/// Against the conditions themselves, and rays against what makes them rays; however the matrix is stored.
TEST(DiagonalContact, BalancesUnknownsWithoutMass) {
    std::mt19937 random(7);
    std::normal_distribution<double> normal;
    int solved = 0, unbounded = 0;
    for (int k = 0; k < 400; ++k) {
        const Index m = 4, n = 14;
        Vector d = Vector::NullaryExpr(n, [&] { return random() % 3 == 0 ? 0.0 : std::exp(normal(random)); });
        SparseMatrix rows(m, n);
        for (Index i = 0; i < m; ++i)
            for (Index j = 3 * i; j < 3 * i + 3; ++j) rows.insert(i, j) = normal(random);
        const SparseMatrix B = rows;
        Vector c = Vector::NullaryExpr(m, [&] { return normal(random); });
        if (k % 5 == 0) c[0] = -infinity;
        Vector b = Vector::NullaryExpr(n, [&] { return normal(random); });
        // A multiplier that balances what has no mass, in most of the programmes.
        for (Index i = 0; i < m; ++i) {
            const double lambda = random() % 2 == 0 && c[i] != -infinity ? std::abs(normal(random)) : 0;
            for (Index j = 3 * i; j < 3 * i + 3; ++j)
                if (d[j] == 0) b[j] = -B.coeff(i, j) * lambda;
        }
        for (Index j = 3 * m; j < n; ++j)
            if (d[j] == 0) b[j] = 0;
        if (k % 4 == 0) b[static_cast<Index>(random() % n)] += 0.3;
        const Vector guess = Vector::NullaryExpr(n, [&] { return normal(random); });
        const DenseMatrix D = d.asDiagonal();
        Vector first;
        for (const Matrix& A : {Matrix::diagonal(d), Matrix(D), Matrix(SparseMatrix(D.sparseView()))}) {
            Vector u = guess, lambda = Vector::Zero(m);
            const auto report = AutomaticContact().prepare(A, Matrix(B))->solve(b, c, {u, lambda});
            EXPECT_EQ(report.strategy, "row by row");
            if (report.outcome == Outcome::unbounded) {
                ++unbounded;
                EXPECT_EQ((D * report.ray).norm(), 0);
                const Vector rate = B * report.ray;
                for (Index i = 0; i < m; ++i) EXPECT_TRUE(c[i] == -infinity || rate[i] >= -1e-14);
                EXPECT_GT(b.dot(report.ray), 0);
                continue;
            }
            ASSERT_EQ(report.outcome, Outcome::converged) << k;
            ++solved;
            EXPECT_LE((D * u - b - B.transpose() * lambda).lpNorm<Eigen::Infinity>(), 1e-12);
            const Vector gap = B * u - c;
            EXPECT_GE(gap.minCoeff(), -1e-12);
            EXPECT_GE(lambda.minCoeff(), 0);
            for (Index i = 0; i < m; ++i) EXPECT_TRUE(lambda[i] == 0 || gap[i] <= 1e-12);
            if (first.size() == 0) first = u;
            EXPECT_EQ((u - first).norm(), 0);
        }
    }
    EXPECT_GT(solved, 100);
    EXPECT_GT(unbounded, 50);
}

}  // namespace
}  // namespace tact
