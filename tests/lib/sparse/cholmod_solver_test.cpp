#include "../../../lib/sparse/cholmod_solver.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/SparseCholesky>

#include "../../../lib/errors.hpp"
#include "random_matrices.hpp"

namespace tact {
namespace {

using test::backward_error;
using test::laplacian;
using test::message_of;
using test::random_columns;
using test::random_spd;
using test::repeated;

DenseMatrix solved(const SparseMatrix& A, DenseMatrix B) {
    CholmodSolver().factorize(Matrix(A))->solve(B);
    return B;
}

DenseMatrix solved_by_eigen(const SparseMatrix& A, const DenseMatrix& B) {
    const Eigen::SimplicialLDLT<SparseMatrix> factor(A);
    EXPECT_EQ(factor.info(), Eigen::Success);
    return factor.solve(B);
}

double difference(const DenseMatrix& X, const DenseMatrix& Y) { return (X - Y).norm() / Y.norm(); }

TEST(CholmodSolver, AgreesWithSimplicialLDLTForAnyNumberOfRightHandSides) {
    unsigned seed = 1;
    for (Index n : {1, 2, 3, 5, 7, 8, 9, 16, 17, 50, 131, 500})
        for (int per_column : {0, 1, 3}) {
            const SparseMatrix A = random_spd(n, per_column, 1, ++seed);
            for (Index columns = 1; columns <= 33; ++columns) {
                const DenseMatrix B = random_columns(n, columns, seed);
                const DenseMatrix X = solved(A, B);
                ASSERT_LT(difference(X, solved_by_eigen(A, B)), 1e-12) << n << " rows, " << columns << " columns";
                ASSERT_LT(backward_error(A, X, B), 2e-15) << n << " rows, " << columns << " columns";
            }
        }
}

TEST(CholmodSolver, AgreesWithDenseCholesky) {
    for (unsigned seed = 1; seed <= 100; ++seed) {
        const Index n = 1 + seed % 40;
        const SparseMatrix A = random_spd(n, static_cast<int>(seed % 6), 1, seed);
        const DenseMatrix B = random_columns(n, 3, seed);
        EXPECT_LT(difference(solved(A, B), DenseMatrix(A).llt().solve(B)), 1e-12);
    }
}

TEST(CholmodSolver, StaysBackwardStableWhenTheConditionIsBad) {
    for (double shift : {1e-3, 1e-6, 1e-9, 1e-11})
        for (unsigned seed = 1; seed <= 20; ++seed) {
            const SparseMatrix A = random_spd(200, 2, shift, seed);
            for (Index columns : {1, 2, 4, 8, 16}) {
                const DenseMatrix B = random_columns(A.rows(), columns, seed);
                const double ours = backward_error(A, solved(A, B), B);
                EXPECT_LT(ours, 4e-15) << "shift " << shift << ", seed " << seed;
                // a right-hand side with a small solution, where the error of an inverse would show
                const DenseMatrix small = A * B;
                EXPECT_LT(backward_error(A, solved(A, small), small), 4e-15) << "shift " << shift;
            }
        }
}

TEST(CholmodSolver, StaysBackwardStableForHighPowersOfTheLaplacian) {
    for (int power : {1, 2, 3}) {
        const SparseMatrix A = laplacian(30, power);
        const DenseMatrix X = random_columns(A.rows(), 2, 7);
        const DenseMatrix B = A * X;
        EXPECT_LT(backward_error(A, solved(A, B), B), 2e-15);
        EXPECT_LT(backward_error(A, solved(A, X), X), 2e-15);
    }
}

TEST(CholmodSolver, BadScalingDoesNoHarm) {
    for (unsigned seed = 1; seed <= 20; ++seed) {
        const SparseMatrix A = test::badly_scaled(random_spd(150, 2, 1, seed), 3, seed);
        const DenseMatrix B = random_columns(A.rows(), 2, seed);
        const DenseMatrix X = solved(A, B);
        EXPECT_LT(backward_error(A, X, B), 2e-15);
        EXPECT_LT(difference(X, solved_by_eigen(A, B)), 1e-11);
    }
}

TEST(CholmodSolver, DenseColumnsMakeWideSupernodes) {
    const DenseMatrix C = random_columns(130, 130, 5);
    const DenseMatrix A = C * C.transpose() + DenseMatrix::Identity(130, 130);
    const SparseMatrix S = A.sparseView();
    for (Index columns : {1, 2, 3, 8, 20}) {
        const DenseMatrix B = random_columns(130, columns, 6);
        EXPECT_LT(difference(solved(S, B), A.llt().solve(B)), 1e-11);
        EXPECT_LT(backward_error(S, solved(S, B), B), 2e-15);
    }
}

TEST(CholmodSolver, AFactorSolvesAgainAndAgain) {
    const SparseMatrix A = laplacian(17);
    const auto factor = CholmodSolver().factorize(Matrix(A));
    EXPECT_EQ(factor->size(), 289);
    for (Index columns : {1, 16, 2, 33, 1, 4, 0}) {
        const DenseMatrix B = random_columns(289, columns, 3);
        DenseMatrix X = B;
        factor->solve(X);
        EXPECT_LT(backward_error(A, X, B), 2e-15);
    }
}

TEST(CholmodSolver, WhatWasNotFiniteIsForgotten) {
    const SparseMatrix A = laplacian(9);
    const auto factor = CholmodSolver().factorize(Matrix(A));
    for (Index columns : {1, 2, 4, 8, 16}) {
        DenseMatrix X = DenseMatrix::Constant(81, columns, infinity);
        factor->solve(X);
        EXPECT_FALSE(X.allFinite());
        const DenseMatrix B = random_columns(81, columns, 2);
        X = B;
        factor->solve(X);
        EXPECT_LT(backward_error(A, X, B), 2e-15);
    }
}

TEST(CholmodSolver, ColumnsMayLieApart) {
    for (Index blocks : {1, 3}) {
        const SparseMatrix A = repeated(laplacian(6), blocks);
        const auto factor = CholmodSolver().factorize(Matrix(A));
        DenseMatrix larger = random_columns(A.rows() + 5, 7, 1);
        const DenseMatrix before = larger;
        factor->solve(larger.topRows(A.rows()));
        EXPECT_LT(backward_error(A, larger.topRows(A.rows()), before.topRows(A.rows())), 2e-15);
        EXPECT_EQ(larger.bottomRows(5), before.bottomRows(5));
    }
}

TEST(CholmodSolver, EqualBlocksAreFoundAndSolvedTogether) {
    for (Index blocks : {2, 3, 17}) {
        const SparseMatrix A = repeated(laplacian(8), blocks);
        EXPECT_EQ(identical_blocks(A), blocks);
        for (Index columns : {1, 2, 5}) {
            const DenseMatrix B = random_columns(A.rows(), columns, 4);
            EXPECT_LT(difference(solved(A, B), solved_by_eigen(A, B)), 1e-13);
        }
    }
    SparseMatrix A = repeated(laplacian(8), 2);
    A.coeffRef(100, 100) += 1e-9;
    EXPECT_EQ(identical_blocks(A), 1);
    EXPECT_EQ(identical_blocks(laplacian(8)), 1);
}

TEST(CholmodSolver, BlocksThatRepeatUpToSignOrAreZeroAgreeWithSimplicialLDLT) {
    const SparseMatrix A = repeated(laplacian(11), 3);
    const Index n = A.rows() / 3;
    const DenseMatrix B0 = random_columns(n, 2, 5);
    const Vector a = B0.col(0), b = B0.col(1), zero = Vector::Zero(n);
    Vector nearly = a;
    nearly[n - 1] += 1e-3;
    DenseMatrix B(3 * n, 6);
    B.col(0) << a, -a, a;
    B.col(1) << a, b, -b;
    B.col(2) << zero, zero, zero;
    B.col(3) << zero, b, zero;
    B.col(4) << a, nearly, -nearly;
    B.col(5) << b, zero, b;
    const DenseMatrix X = solved(A, B);
    EXPECT_LT(difference(X, solved_by_eigen(A, B)), 1e-13);
    EXPECT_EQ(X.col(0).segment(n, n), -X.col(0).head(n));
    EXPECT_EQ(X.col(2), Vector::Zero(3 * n));
}

TEST(CholmodSolver, ColumnsOfTheUnitMatrixAgreeWithSimplicialLDLT) {
    const SparseMatrix A = laplacian(17);
    for (const Index columns : {1, 2, 3, 8, 16, 40}) {
        DenseMatrix B = DenseMatrix::Zero(A.rows(), columns);
        for (Index j = 0; j < columns; ++j) B((j * 37) % A.rows(), j) = 1;
        EXPECT_LT(difference(solved(A, B), solved_by_eigen(A, B)), 1e-13);
    }
}

TEST(CholmodSolver, DenseAndDiagonalMatricesAreTaken) {
    const SparseMatrix A = random_spd(12, 2, 1, 3);
    DenseMatrix X = random_columns(12, 2, 4);
    const DenseMatrix B = X;
    CholmodSolver().factorize(Matrix(DenseMatrix(A)))->solve(X);
    EXPECT_LT(difference(X, solved(A, B)), 1e-13);
    const Vector d = Vector::LinSpaced(12, 1, 7);
    X = B;
    CholmodSolver().factorize(Matrix::diagonal(d))->solve(X);
    EXPECT_LT(difference(X, d.cwiseInverse().asDiagonal() * B), 1e-15);
}

TEST(CholmodSolver, NamesTheMatrixThatIsNotPositiveDefinite) {
    SparseMatrix A = laplacian(5);
    A.coeffRef(12, 12) = -1;
    EXPECT_THROW(CholmodSolver().factorize(Matrix(A)), NumericalError);
    const auto message = message_of([&] { CholmodSolver().factorize(Matrix(A)); });
    EXPECT_NE(message.find("25x25 sparse matrix is singular or not positive definite"), std::string::npos) << message;
    EXPECT_THROW(CholmodSolver().factorize(Matrix(repeated(A, 2))), NumericalError);
}

TEST(CholmodSolver, NamesTheMatrixThatIsSingularToRounding) {
    // a chain of springs that nothing holds
    test::Triplets entries;
    for (long i = 0; i < 20; ++i) {
        entries.emplace_back(i, i, i == 0 || i == 19 ? 1. / 3 : 2. / 3);
        if (i > 0) entries.emplace_back(i, i - 1, -1. / 3);
        if (i < 19) entries.emplace_back(i, i + 1, -1. / 3);
    }
    const Matrix A(test::assemble(20, entries));
    EXPECT_THROW(CholmodSolver().factorize(A), NumericalError);
    const auto message = message_of([&] { CholmodSolver().factorize(A); });
    EXPECT_NE(message.find("20x20 sparse matrix is singular"), std::string::npos) << message;
}

TEST(CholmodSolver, RefusesWhatIsNotSymmetricOrNotSquare) {
    EXPECT_THROW(CholmodSolver().factorize(Matrix(test::random_sparse(9, 2, 1))), InputError);
    EXPECT_THROW(CholmodSolver().factorize(Matrix(SparseMatrix(3, 4))), InputError);
    EXPECT_THROW(CholmodSolver().factorize(Matrix()), InputError);
}

}  // namespace
}  // namespace tact
