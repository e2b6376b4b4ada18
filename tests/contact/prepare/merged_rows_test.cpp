// Against the enumeration of all active sets of the problem without the repeated rows.
#include "../../../contact/prepare/merged_rows.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "../../../contact/automatic.hpp"
#include "../../laws/quadratic_programs.hpp"

namespace tact::laws {
namespace {

/// Each row a second time, three times as large with a looser bound, and a third time as it is with a tighter one.
QuadraticProgram with_repeats(const QuadraticProgram& qp, double tighter) {
    const Index m = qp.B.rows();
    QuadraticProgram more = qp;
    more.B.resize(3 * m, qp.B.cols());
    more.B << qp.B, 3 * qp.B, qp.B;
    more.c.resize(3 * m);
    more.c << qp.c, (3 * qp.c).array() - 1, qp.c.array() + tighter;
    return more;
}

Matrix sparse(const DenseMatrix& M) { return Matrix(Matrix(M).to_sparse()); }

TEST(MergedRows, TheTightestBoundHoldsAndItsRowCarriesTheForce) {
    std::mt19937 random(8);
    for (const Rows kind : {Rows::bounds, Rows::pairs, Rows::general})
        for (int k = 0; k < 20; ++k) {
            QuadraticProgram qp = random_program(random, 10, 4, kind);
            const QuadraticProgram more = with_repeats(qp, 0.125);
            qp.c.array() += 0.125;
            const auto exact = by_enumeration(qp);
            ASSERT_TRUE(exact);
            Index rows = -1;
            const auto prepared =
                prepare_merged(sparse(more.A), sparse(more.B), [&](const Matrix& A, const Matrix& B) {
                    rows = B.rows();
                    return AutomaticContact().prepare(A, B);
                });
            EXPECT_EQ(rows, 4);
            Vector u = Vector::Zero(10), lambda = Vector::Ones(12);
            const auto report = prepared->solve(more.b, more.c, {u, lambda});
            ASSERT_EQ(report.outcome, Outcome::converged);
            EXPECT_LE((u - exact->u).norm(), 1e-9 * (1 + exact->u.norm()));
            EXPECT_EQ(lambda.head(8), Vector::Zero(8));
            EXPECT_LE((lambda.tail(4) - exact->lambda).norm(), 1e-8 * (1 + exact->lambda.norm()));
            EXPECT_LE(kkt_residuals(Matrix(more.A), Matrix(more.B), more.b, more.c, u, lambda).largest(), 1e-12);
        }
}

TEST(MergedRows, OppositeAndEmptyRowsStayAndSoDoRowsOfOnePatternThatDiffer) {
    DenseMatrix B(6, 3);
    B << 1, 2, 0, -1, -2, 0, 1, 2.5, 0, 0, 0, 0, 0, 0, 0, 2, 4, 0;
    Index rows = -1;
    (void)prepare_merged(Matrix::identity(3), sparse(B), [&](const Matrix& A, const Matrix& kept) {
        rows = kept.rows();
        return AutomaticContact().prepare(A, kept);
    });
    EXPECT_EQ(rows, 5);
}

TEST(MergedRows, RowsWhoseFactorIsNoNumberToWorkWithStayApart) {
    DenseMatrix B(3, 2);
    B << 1e-160, 2e-160, 1e160, 2e160, 2e160, 4e160;
    Index rows = -1;
    (void)prepare_merged(Matrix::identity(2), sparse(B), [&](const Matrix& A, const Matrix& kept) {
        rows = kept.rows();
        return AutomaticContact().prepare(A, kept);
    });
    EXPECT_EQ(rows, 2);
}

TEST(MergedRows, CertificatesAndFailuresAreTheCallers) {
    DenseMatrix B(3, 2);
    B << 1, 1, 2, 2, -1, -1;
    const Matrix rows = sparse(B);
    const auto prepared = AutomaticContact().prepare(Matrix::identity(2), rows);
    Vector u = Vector::Constant(2, 0.5), lambda = Vector::Zero(3);
    Vector c{{0, 2, 0.5}};  // the sum >= 1 by the second row, <= -.5 by the third
    const auto report = prepared->solve(Vector::Zero(2), c, {u, lambda});
    ASSERT_EQ(report.outcome, Outcome::infeasible);
    ASSERT_EQ(report.infeasibility.size(), 3);
    EXPECT_GE(report.infeasibility.minCoeff(), 0);
    EXPECT_LE((B.transpose() * report.infeasibility).norm(), 1e-12);
    EXPECT_GT(c.dot(report.infeasibility), 0);
    EXPECT_EQ(u, Vector::Constant(2, 0.5));

    for (Index row = 0; row < 2; ++row) {
        c << -1, -1, -1;
        c[row] = std::numeric_limits<double>::quiet_NaN();
        EXPECT_NE(prepared->solve(Vector::Zero(2), c, {u, lambda}).outcome, Outcome::converged);
        EXPECT_EQ(u, Vector::Constant(2, 0.5));
    }
}

}  // namespace
}  // namespace tact::laws
