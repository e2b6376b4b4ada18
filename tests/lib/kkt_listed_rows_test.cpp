#include <gtest/gtest.h>

#include <vector>

#include "../../lib/errors.hpp"
#include "../../lib/kkt.hpp"

namespace tact {
namespace {

TEST(KktResiduals, OfListedRowsAreThoseOfTheProblemWithTheseRowsAlone) {
    const Index n = 21, m = 400;
    const DenseMatrix B = DenseMatrix::Random(m, n);
    const Vector b = Vector::Random(n), u = Vector::Random(n);
    Vector c = Vector::Random(m), lambda = Vector::Zero(m);
    std::vector<Index> rows;
    for (Index i = 0; i < m; i += (i < 390 ? 1 : 3)) rows.push_back(i);
    lambda[rows[3]] = 2;
    lambda[rows[390]] = -0.1;
    const Vector c_listed = c(rows), lambda_listed = lambda(rows);
    const DenseMatrix B_listed = B(rows, Eigen::all);
    for (const Matrix& A : {Matrix::diagonal(Vector::Random(n)), Matrix(DenseMatrix(DenseMatrix::Random(n, n)))}) {
        const KktResiduals listed = KktCertificate(A, Matrix(B))(b, c, u, lambda, rows);
        const KktResiduals r = kkt_residuals(A, Matrix(B_listed), b, c_listed, u, lambda_listed);
        EXPECT_NEAR(listed.stationarity, r.stationarity, 1e-14);
        EXPECT_NEAR(listed.penetration, r.penetration, 1e-14);
        EXPECT_NEAR(listed.negativity, r.negativity, 1e-14);
        EXPECT_NEAR(listed.complementarity, r.complementarity, 1e-14);
        const KktResiduals none = KktCertificate(A, Matrix(B))(b, c, u, lambda, {});
        EXPECT_EQ(none.penetration, 0);
        EXPECT_GT(none.stationarity, 0);
    }
    const Matrix sparse(SparseMatrix(B.sparseView()));
    EXPECT_THROW((void)KktCertificate(Matrix::identity(n), sparse)(b, c, u, lambda, rows), InputError);
}

}  // namespace
}  // namespace tact
