#include "../../../lib/problem/matrix.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "../../../lib/errors.hpp"

namespace tact {
namespace {

DenseMatrix example() {
    DenseMatrix A(3, 4);
    A << 1, 0, -2, 0, 0, 3, 0, 4, 5, 0, 0, -6;
    return A;
}

TEST(Matrix, EveryKindMultipliesAsEigensDenseMatrixDoes) {
    const DenseMatrix A = example();
    const Vector x = Vector::LinSpaced(4, -1, 2), y = Vector::LinSpaced(3, 3, 5);
    for (const Matrix& M : {Matrix(A), Matrix(SparseMatrix(A.sparseView()))}) {
        Vector forward = y, backward = x;
        M.multiply(x, forward, 2, -1);
        EXPECT_LE((forward - (2 * A * x - y)).norm(), 1e-14);
        M.multiply_transposed(y, backward, 2, -1);
        EXPECT_LE((backward - (2 * A.transpose() * y - x)).norm(), 1e-14);
        EXPECT_EQ(M.to_dense(), A);
        EXPECT_EQ(DenseMatrix(M.to_sparse()), A);
        EXPECT_LE((M.times(DenseMatrix::Identity(4, 4)) - A).norm(), 1e-14);
        EXPECT_LE((M.transposed_times(DenseMatrix::Identity(3, 3)) - A.transpose()).norm(), 1e-14);
    }
    const Matrix d = Matrix::diagonal(x);
    EXPECT_EQ(d * x, x.cwiseAbs2());
    EXPECT_EQ(d.main_diagonal(), x);
}

/// What the arrays say, entry by entry, as SciPy sums them.
DenseMatrix summed(Index rows, const std::vector<long>& starts, const std::vector<long>& inner,
                   const std::vector<double>& entries) {
    DenseMatrix A = DenseMatrix::Zero(rows, static_cast<Index>(starts.size()) - 1);
    for (Index j = 0; j < A.cols(); ++j)
        for (long k = starts[static_cast<std::size_t>(j)]; k < starts[static_cast<std::size_t>(j + 1)]; ++k)
            A(inner[static_cast<std::size_t>(k)], j) += entries[static_cast<std::size_t>(k)];
    return A;
}

void expect_in_order(const Matrix& A) {
    const SparseMatrix& S = *A.sparse();
    for (Index j = 0; j < S.cols(); ++j)
        for (long k = S.outerIndexPtr()[j] + 1; k < S.outerIndexPtr()[j + 1]; ++k)
            EXPECT_LT(S.innerIndexPtr()[k - 1], S.innerIndexPtr()[k]);
}

TEST(Matrix, SortsRowsAndSumsThoseThatComeTwice) {
    const std::vector<long> starts{0, 3, 3, 7, 8}, inner{2, 0, 1, 1, 1, 0, 1, 2};
    const std::vector<double> entries{1, 2, 3, 4, -4, 5, 6, 7};
    const Matrix A = Matrix::from_columns(3, 4, starts, inner, entries);
    EXPECT_EQ(A.to_dense(), summed(3, starts, inner, entries));
    expect_in_order(A);
    // The same arrays in a matrix of Eigen's, which does not look at them.
    SparseMatrix raw(3, 4);
    raw.resizeNonZeros(8);
    std::copy(starts.begin(), starts.end(), raw.outerIndexPtr());
    std::copy(inner.begin(), inner.end(), raw.innerIndexPtr());
    std::copy(entries.begin(), entries.end(), raw.valuePtr());
    const Matrix B(raw);
    EXPECT_EQ(B.to_dense(), A.to_dense());
    expect_in_order(B);
}

/// A Laplacian given in four ways is one matrix, and symmetric.
TEST(Matrix, IsSymmetricHoweverItsRowsAreOrdered) {
    for (const long n : {3L, 50L})
        for (const int way : {0, 1, 2, 3}) {
            std::vector<long> starts{0}, inner;
            std::vector<double> entries;
            for (long j = 0; j < n; ++j) {
                std::vector<std::pair<long, double>> column;
                if (j > 0) column.emplace_back(j - 1, -1);
                column.emplace_back(j, way >= 2 ? 0.5 : 2);
                if (j + 1 < n) column.emplace_back(j + 1, -1);
                if (way >= 2) column.emplace_back(j, 1.5);
                if (way % 2 == 1) std::reverse(column.begin(), column.end());
                for (const auto& [i, x] : column) inner.push_back(i), entries.push_back(x);
                starts.push_back(static_cast<long>(inner.size()));
            }
            const Matrix K = Matrix::from_columns(n, n, starts, inner, entries);
            expect_in_order(K);
            EXPECT_TRUE(K.is_symmetric()) << n << ' ' << way;
            EXPECT_EQ(K.sparse()->nonZeros(), 3 * n - 2);
            EXPECT_EQ(K.main_diagonal(), Vector::Constant(n, 2));
        }
}

TEST(Matrix, RefusesIndicesThatAreNotThere) {
    const std::vector<long> starts{0, 1, 2}, inner{0, 1};
    const std::vector<double> entries{1, 2};
    const auto from = [&](Index rows, Index cols, std::vector<long> s, std::vector<long> i) {
        return Matrix::from_columns(rows, cols, s, i, entries);
    };
    EXPECT_EQ(from(2, 2, starts, inner).sparse()->nonZeros(), 2);
    EXPECT_THROW((void)from(2, 2, starts, {0, 2}), InputError);
    EXPECT_THROW((void)from(2, 2, starts, {-1, 1}), InputError);
    EXPECT_THROW((void)from(2, 2, {0, 1}, inner), InputError);
    EXPECT_THROW((void)from(2, 2, {0, 1, 3}, inner), InputError);
    EXPECT_THROW((void)from(2, 2, {1, 1, 2}, inner), InputError);
    EXPECT_THROW((void)from(2, 3, {0, 2, 1, 2}, inner), InputError);
    EXPECT_THROW((void)from(2, 2, starts, {0}), InputError);
    EXPECT_THROW((void)from(-1, 2, starts, inner), InputError);
    SparseMatrix wrong(2, 2);
    wrong.insert(0, 0) = 1;
    wrong.makeCompressed();
    wrong.innerIndexPtr()[0] = 5;
    EXPECT_THROW((void)Matrix(wrong), InputError);
}

TEST(Matrix, TakesOneThatIsNotCompressed) {
    SparseMatrix A(3, 3);
    A.reserve(Eigen::VectorXi::Constant(3, 3));
    A.insert(2, 0) = 1;
    A.insert(0, 0) = 2;
    A.insert(1, 2) = 3;
    ASSERT_FALSE(A.isCompressed());
    const Matrix compressed(A);
    EXPECT_TRUE(compressed.sparse()->isCompressed());
    EXPECT_EQ(compressed.to_dense(), DenseMatrix(A));
    expect_in_order(compressed);
}

TEST(Matrix, SubnormalEntriesAreTakenAsZeroAndNaNIsKept) {
    const double tiny = std::numeric_limits<double>::denorm_min(), normal = std::numeric_limits<double>::min();
    DenseMatrix A(2, 2);
    A << tiny, -normal, -tiny, infinity;
    for (const Matrix& M : {Matrix(A), Matrix(SparseMatrix(A.sparseView(0, 0)))}) {
        EXPECT_EQ(M.to_dense()(0, 0), 0);
        EXPECT_EQ(M.to_dense()(1, 0), 0);
        EXPECT_EQ(M.to_dense()(0, 1), -normal);
        EXPECT_FALSE(M.all_finite());
    }
    const Matrix d = Matrix::diagonal(Vector{{tiny, normal, std::numeric_limits<double>::quiet_NaN()}});
    EXPECT_EQ(d.main_diagonal()[0], 0);
    EXPECT_EQ(d.main_diagonal()[1], normal);
    EXPECT_FALSE(d.all_finite());
}

TEST(Matrix, BetaZeroOverwritesNaN) {
    Vector y = Vector::Constant(3, std::numeric_limits<double>::quiet_NaN());
    Matrix(SparseMatrix(example().sparseView())).multiply(Vector::Ones(4), y);
    EXPECT_TRUE(y.allFinite());
}

TEST(Matrix, CopiesShareTheirStorage) {
    const Matrix A = Matrix::identity(3);
    const Matrix copy = A;
    EXPECT_TRUE(copy.same_storage(A));
    EXPECT_FALSE(Matrix::identity(3).same_storage(A));
}

TEST(Matrix, CombineKeepsTheSparsestKind) {
    const Matrix d = Matrix::identity(3), s(SparseMatrix(DenseMatrix::Identity(3, 3).sparseView())),
                 f(DenseMatrix(DenseMatrix::Ones(3, 3)));
    EXPECT_TRUE(combine(1, d, 2, d).diagonal_entries());
    EXPECT_TRUE(combine(1, d, 2, s).sparse());
    EXPECT_TRUE(combine(1, s, 2, f).dense());
    EXPECT_EQ(combine(3, d, 2, s).to_dense(), DenseMatrix(5 * DenseMatrix::Identity(3, 3)));
    EXPECT_THROW(combine(1, d, 1, Matrix::identity(4)), InputError);
}

/// Entry by entry, as the header says it.
bool symmetric_by_definition(const DenseMatrix& A, double tolerance) {
    for (Index i = 0; i < A.rows(); ++i)
        for (Index j = 0; j < A.cols(); ++j) {
            const double allowed = std::sqrt(std::abs(A(i, i) * A(j, j)));
            if (std::abs(A(i, j) - A(j, i)) > tolerance * std::max({std::abs(A(i, j)), std::abs(A(j, i)), allowed}))
                return false;
        }
    return true;
}

TEST(Matrix, SparseSymmetryAgreesWithTheDefinitionOnTheDenseMatrix) {
    std::srand(3);
    for (int trial = 0; trial < 200; ++trial) {
        const Index n = 1 + trial % 7;
        DenseMatrix A = DenseMatrix::Random(n, n);
        A = (A.array().abs() < 0.6).select(0.0, A);
        if (trial % 3 > 0) A = (A + A.transpose()).eval();
        if (trial % 3 == 1) A(trial % n, 0) += trial % 2 == 0 ? 1e-13 : 1e-6;
        SparseMatrix S = A.sparseView();
        if (trial % 5 == 0) S.coeffRef(0, n - 1) += 0;  // stored zeros make the pattern one-sided
        for (const double tolerance : {0.0, 1e-12, 1e-3}) {
            EXPECT_EQ(Matrix(S).is_symmetric(tolerance), symmetric_by_definition(A, tolerance)) << A;
            EXPECT_EQ(Matrix(A).is_symmetric(tolerance), symmetric_by_definition(A, tolerance)) << A;
        }
    }
}

TEST(Matrix, SymmetryIsRelativeToTheDiagonalAndNoLargeEntryExcusesAnother) {
    DenseMatrix A = DenseMatrix::Identity(2, 2) * 1e8;
    A(0, 1) = 1e-6;
    EXPECT_TRUE(Matrix(A).is_symmetric());
    EXPECT_TRUE(Matrix(SparseMatrix(A.sparseView())).is_symmetric());
    A(0, 1) = 1;
    EXPECT_FALSE(Matrix(A).is_symmetric());
    EXPECT_FALSE(Matrix(SparseMatrix(A.sparseView())).is_symmetric());
    DenseMatrix stiff = DenseMatrix::Identity(3, 3);
    stiff(0, 0) = 1e20;
    stiff(1, 2) = 0.5;
    EXPECT_FALSE(Matrix(stiff).is_symmetric());
    EXPECT_FALSE(Matrix(SparseMatrix(stiff.sparseView())).is_symmetric());
}

}  // namespace
}  // namespace tact
