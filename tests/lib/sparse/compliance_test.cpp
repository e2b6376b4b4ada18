// B A^-1 B' formed on the paths of the elimination tree, against Eigen's factors, which know nothing of paths.
#include <gtest/gtest.h>

#include <Eigen/SparseCholesky>
#include <random>

#include "../../../lib/sparse/cholmod_solver.hpp"
#include "../../../lib/sparse/klu_solver.hpp"
#include "random_matrices.hpp"

namespace tact {
namespace {

using test::laplacian;
using test::random_spd;
using test::repeated;

/// Columns with some entries each; in a matrix of equal blocks some repeat up to sign, some are alone, some are empty.
SparseMatrix some_columns(Index block, Index blocks, Index columns, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_int_distribution<Index> row(0, block - 1);
    std::uniform_int_distribution<int> kind(0, 4);
    std::uniform_real_distribution<double> value(-1, 1);
    std::vector<Eigen::Triplet<double>> entries;
    for (Index j = 0; j < columns; ++j) {
        const int which = kind(random);
        if (which == 0) continue;
        for (int part = 0; part < 3; ++part) {
            const Index i = row(random);
            const double v = value(random);
            if (which == 1) entries.emplace_back(i, j, v);
            if (which > 1) entries.emplace_back((blocks - 1) * block + i, j, v);
            if (which == 2) entries.emplace_back(i, j, -v);
            if (which == 3) entries.emplace_back(i, j, v);
            if (which == 4) entries.emplace_back(row(random), j, value(random));
        }
    }
    SparseMatrix R(blocks * block, columns);
    R.setFromTriplets(entries.begin(), entries.end());
    return R;
}

double difference(const Factor& factor, const SparseMatrix& A, const SparseMatrix& R, Index first) {
    const Index m = R.cols();
    const Eigen::SimplicialLDLT<SparseMatrix> eigen(A);
    const DenseMatrix expected = R.transpose() * DenseMatrix(eigen.solve(DenseMatrix(R)));
    DenseMatrix S = DenseMatrix::Constant(m + 2, m + 3, 7);
    factor.compliance(R, first, S);
    double worst = 0;
    for (Index j = 0; j < m; ++j)
        for (Index i = 0; i <= j; ++i)
            worst = std::max(worst, j < first ? S(i, j) - 7 : std::abs(S(i, j) - expected(i, j)));
    return worst / expected.norm();
}

TEST(Compliance, OnPathsAgreesWithSimplicialLDLT) {
    unsigned seed = 0;
    for (const Index columns : {1, 2, 15, 16, 17, 40, 100})
        for (const Index blocks : {1, 2, 3})
            for (const Index side : {3, 7, 20}) {
                const SparseMatrix A = repeated(laplacian(side, 2), blocks);
                const SparseMatrix R = some_columns(side * side, blocks, columns, ++seed);
                if (R.norm() == 0) continue;
                const auto factor = CholmodSolver().factorize(Matrix(A));
                // twice: what the first left behind must not show
                for (const Index first : {Index{0}, columns / 2, columns - 1})
                    EXPECT_LT(difference(*factor, A, R, first), 1e-12) << columns << " columns, side " << side;
            }
}

TEST(Compliance, OfMatricesWithoutStructureAgreesWithSimplicialLDLT) {
    for (unsigned seed = 1; seed <= 40; ++seed) {
        const Index n = 1 + 7 * seed % 300;
        const SparseMatrix A = random_spd(n, static_cast<int>(seed % 4), 1, seed);
        const SparseMatrix R = some_columns(n, 1, 20, seed);
        if (R.norm() == 0) continue;
        EXPECT_LT(difference(*CholmodSolver().factorize(Matrix(A)), A, R, 0), 1e-12) << n << " unknowns";
    }
}

TEST(Compliance, OfForestsAgreesWithSimplicialLDLT) {
    // Unknowns that nothing joins: each is a root of its own.
    const Vector d = Vector::LinSpaced(50, 1, 3);
    const SparseMatrix A = Matrix::diagonal(d).to_sparse();
    const SparseMatrix R = some_columns(50, 1, 30, 3);
    EXPECT_LT(difference(*CholmodSolver().factorize(Matrix(A)), A, R, 0), 1e-14);
}

TEST(Compliance, ByWholeColumnsAgreesWithSimplicialLDLT) {
    const SparseMatrix A = repeated(laplacian(8), 2);
    const SparseMatrix R = some_columns(64, 2, 70, 5);
    EXPECT_LT(difference(*KluSolver().factorize(Matrix(A)), A, R, 3), 1e-13);
    const DenseMatrix dense(A);
    EXPECT_LT(difference(*DenseLinearSolver().factorize(Matrix(dense)), A, R, 0), 1e-13);
}

}  // namespace
}  // namespace tact
