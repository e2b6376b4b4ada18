#include "../../../lib/sparse/klu_solver.hpp"

#include <gtest/gtest.h>

#include <Eigen/SparseLU>

#include "../../../lib/errors.hpp"
#include "random_matrices.hpp"

namespace tact {
namespace {

using test::assemble;
using test::backward_error;
using test::message_of;
using test::random_columns;
using test::random_sparse;

DenseMatrix solved_by_eigen(const SparseMatrix& A, const DenseMatrix& B) {
    Eigen::SparseMatrix<double> copy = A;
    const Eigen::SparseLU<Eigen::SparseMatrix<double>> factor(copy);
    EXPECT_EQ(factor.info(), Eigen::Success);
    return factor.solve(B);
}

/// [[a, 1], [1, 1]]: a good pivot in the corner or a bad one.
SparseMatrix corner(double a) { return assemble(2, {{0, 0, a}, {1, 0, 1.}, {0, 1, 1.}, {1, 1, 1.}}); }

TEST(KluSolver, AgreesWithSparseLU) {
    for (unsigned seed = 1; seed <= 40; ++seed) {
        const Index n = 1 + 13 * (seed - 1);
        SparseMatrix A = random_sparse(n, 3, seed);
        for (Index i = 0; i < n; ++i) A.coeffRef(i, i) += 4;
        const DenseMatrix B = random_columns(n, 1 + seed % 4, seed);
        DenseMatrix X = B;
        KluSolver().factorize(Matrix(A))->solve(X);
        EXPECT_LT(backward_error(A, X, B), 1e-14);
        const DenseMatrix expected = solved_by_eigen(A, B);
        EXPECT_LT((X - expected).norm(), 1e-9 * expected.norm()) << n << " rows";
    }
}

TEST(KluSolver, NamesTheSingularMatrix) {
    const Matrix empty_column(assemble(3, {{0, 0, 1.}, {1, 1, 1.}, {2, 1, 1.}}));
    EXPECT_THROW(KluSolver().factorize(empty_column), NumericalError);
    const Matrix dependent(assemble(2, {{0, 0, 1.}, {1, 0, 2.}, {0, 1, 2.}, {1, 1, 4.}}));
    EXPECT_THROW(KluSolver().factorize(dependent), NumericalError);
    const auto message = message_of([&] { KluSolver().factorize(dependent); });
    EXPECT_NE(message.find("2x2"), std::string::npos) << message;
    EXPECT_THROW(KluSolver().factorize(Matrix(SparseMatrix(3, 4))), InputError);
}

TEST(KluRefactorable, KeepsItsPivotsWhileTheyAreGood) {
    SparseMatrix A = random_sparse(120, 3, 5);
    for (Index i = 0; i < A.rows(); ++i) A.coeffRef(i, i) += 10;
    KluRefactorable klu(A);
    for (unsigned step = 0; step < 5; ++step) {
        for (double& x : klu.matrix().coeffs()) x *= 1 + 0.01 * step;
        ASSERT_TRUE(klu.refactor());
        const Vector b = random_columns(120, 1, step);
        Vector x = b;
        klu.solve(x);
        EXPECT_LT(backward_error(klu.matrix(), x, b), 1e-14);
    }
    EXPECT_EQ(klu.full_factorisations(), 1);
}

TEST(KluRefactorable, TakesFreshPivotsWhenTheOldOnesHaveBecomeBad) {
    KluRefactorable klu(corner(2));
    ASSERT_TRUE(klu.refactor());
    for (double a : {1e-14, 1e-30, 0.}) {
        klu.matrix() = corner(a);
        ASSERT_TRUE(klu.refactor()) << a;
        const Vector b = Eigen::Vector2d(1, 3);
        Vector x = b;
        klu.solve(x);
        EXPECT_LT(backward_error(klu.matrix(), x, b), 1e-15) << a;
        klu.matrix() = corner(1e14);
        ASSERT_TRUE(klu.refactor());
        x = b;
        klu.solve(x);
        EXPECT_LT(backward_error(klu.matrix(), x, b), 1e-15) << a;
    }
    EXPECT_GT(klu.full_factorisations(), 1);
}

TEST(KluRefactorable, SaysSingularAndRecovers) {
    KluRefactorable klu(corner(2));
    ASSERT_TRUE(klu.refactor());
    klu.matrix() = corner(1);
    EXPECT_FALSE(klu.refactor());
    klu.matrix() = corner(2);
    ASSERT_TRUE(klu.refactor());
    Vector x = Eigen::Vector2d(3, 2);
    klu.solve(x);
    EXPECT_LT((x - Eigen::Vector2d(1, 1)).norm(), 1e-15);
}

/// Against Eigen's SparseLU: solves, transposed solves and compliances, of one body, of two equal ones, and unsymmetric.
TEST(KluFactor, AgreesWithSparseLUAsACholeskyFactorToo) {
    for (const bool symmetric : {true, false})
        for (const Index bodies : {1, 2}) {
            const Index k = 12, n = bodies * k * k;
            std::vector<Eigen::Triplet<double, long>> entries;
            for (Index row = 0; row < n; ++row) {
                const Index i = row % (k * k) / k, j = row % k;
                entries.emplace_back(row, row, 4.1 + 0.01 * static_cast<double>(i + j));
                if (i > 0) entries.emplace_back(row, row - k, -1.0);
                if (i + 1 < k) entries.emplace_back(row, row + k, symmetric ? -1.0 : -0.3);
                if (j > 0) entries.emplace_back(row, row - 1, symmetric ? -1.0 : -1.4);
                if (j + 1 < k) entries.emplace_back(row, row + 1, -1.0);
            }
            SparseMatrix A(n, n);
            A.setFromTriplets(entries.begin(), entries.end());
            const KluFactor factor(A, symmetric);
            EXPECT_EQ(factor.symmetric(), symmetric);
            Eigen::SparseLU<SparseMatrix> direct(A), transposed(SparseMatrix(A.transpose()));
            const DenseMatrix F = DenseMatrix::Random(n, 5);
            DenseMatrix X = F, Y = F;
            factor.solve(X);
            factor.solve_transposed(Y);
            EXPECT_LE((X - direct.solve(F)).norm(), 1e-13 * X.norm());
            EXPECT_LE((Y - transposed.solve(F)).norm(), 1e-13 * Y.norm());
            SparseMatrix R(n, 3);
            R.insert(3, 0) = 1;
            R.insert(k, 1) = -2;
            R.insert(n - 1, 2) = 1;
            const DenseMatrix exact = R.transpose() * DenseMatrix(direct.solve(DenseMatrix(R)));
            DenseMatrix S(3, 3);
            factor.compliance(R, 0, S);
            for (Index j = 0; j < 3; ++j)
                for (Index i = 0; i <= j; ++i) EXPECT_NEAR(S(i, j), exact(i, j), 1e-13 * exact.norm());
        }
}

}  // namespace
}  // namespace tact
