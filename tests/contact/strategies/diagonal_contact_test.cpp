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
    EXPECT_THROW((void)DiagonalContact().prepare(Matrix::diagonal(Vector{{1, 0, 1}}), pairs), InputError);
}

}  // namespace
}  // namespace tact
