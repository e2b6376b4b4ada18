#include "../../../rom/model/reduced_basis.hpp"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <limits>

#include "../../../lib/errors.hpp"
#include "../chain.hpp"

namespace tact {
namespace {

using testing::chain;
using testing::identity;
using testing::scattered;

constexpr Index n = 30, p = 7;

std::string refusal(const ReducedBasis& basis) {
    try {
        validate(basis, chain(n));
    } catch (const InputError& error) {
        return error.what();
    }
    return "accepted";
}

TEST(ReducedBasis, NamesWhatIsWrongWithIt) {
    const ReducedBasis good{scattered(n, p), scattered(n / 2, 3).cwiseAbs()};
    EXPECT_EQ(refusal(good), "accepted");
    ReducedBasis bad = good;
    bad.U_lambda(4, 2) = -0.5;
    EXPECT_EQ(refusal(bad), "ReducedBasis: U_lambda(4,2) is -0.5, expected a finite entry >= 0");
    bad = good;
    bad.U(6, 1) = std::numeric_limits<double>::quiet_NaN();
    EXPECT_NE(refusal(bad).find("U(6,1) is nan"), std::string::npos) << refusal(bad);
    bad = good;
    bad.U_lambda(0, 0) = infinity;
    EXPECT_NE(refusal(bad).find("U_lambda(0,0)"), std::string::npos);
    EXPECT_EQ(refusal({scattered(n + 1, p), good.U_lambda}),
              "ReducedBasis: U is 31x7, expected 30 rows and at least one column");
    EXPECT_EQ(refusal({good.U, scattered(n, 3).cwiseAbs()}), "ReducedBasis: U_lambda is 30x3, expected 15 rows");
    EXPECT_EQ(refusal({good.U, DenseMatrix()}), "accepted");
}

/// Projector on the span of X, from a decomposition the code under test does not use.
DenseMatrix projector(const DenseMatrix& X) { return X * X.completeOrthogonalDecomposition().pseudoInverse(); }

DenseMatrix sandwich(const DenseMatrix& U, const Matrix& A) { return U.transpose() * A.to_dense() * U; }

double off_diagonal(const DenseMatrix& A) {
    return (A - DenseMatrix(A.diagonal().asDiagonal())).cwiseAbs().maxCoeff();
}

void expect_ascending(const DenseMatrix& A) {
    for (Index i = 1; i < A.rows(); ++i) EXPECT_LE(A(i - 1, i - 1), A(i, i));
}

TEST(ModalBasis, MakesMassTheIdentityAndStiffnessDiagonalOnTheSameSpan) {
    const ContactProblem problem = chain(n);
    const ReducedBasis raw{scattered(n, p), scattered(n / 2, 3).cwiseAbs()};
    const ReducedBasis modal = modal_basis(problem, raw);
    EXPECT_LT((sandwich(modal.U, *problem.M) - identity(p)).cwiseAbs().maxCoeff(), 1e-13);
    const DenseMatrix K_r = sandwich(modal.U, problem.K);
    EXPECT_LT(off_diagonal(K_r), 1e-13);
    expect_ascending(K_r);
    EXPECT_LT((projector(modal.U) - projector(raw.U)).norm(), 1e-11);
    EXPECT_EQ(modal.U_lambda, raw.U_lambda);
    for (Index j = 0; j < p; ++j) EXPECT_EQ(modal.U.col(j).maxCoeff(), modal.U.col(j).cwiseAbs().maxCoeff());
}

TEST(ModalBasis, OfTheWholeSpaceHoldsTheEigenvectors) {
    const ContactProblem problem = chain(n);
    const ReducedBasis modal = modal_basis(problem, {identity(n), {}});
    const Vector w = sandwich(modal.U, problem.K).diagonal();
    const DenseMatrix residual =
        problem.K.to_dense() * modal.U - problem.M->to_dense() * modal.U * DenseMatrix(w.asDiagonal());
    EXPECT_LT(residual.cwiseAbs().maxCoeff(), 1e-12);
}

TEST(ModalBasis, IsOrthonormalInStaticsAndUsesDampingWithoutMass) {
    const ContactProblem still = chain(n, -0.4, {.mass = false});
    const DenseMatrix U = modal_basis(still, {scattered(n, p), {}}).U;
    EXPECT_LT((U.transpose() * U - identity(p)).cwiseAbs().maxCoeff(), 1e-13);
    EXPECT_LT(off_diagonal(sandwich(U, still.K)), 1e-13);

    const ContactProblem creeping = chain(n, -0.4, {.mass = false, .damping = true});
    const DenseMatrix V = modal_basis(creeping, {scattered(n, p), {}}).U;
    EXPECT_LT((sandwich(V, *creeping.D) - identity(p)).cwiseAbs().maxCoeff(), 1e-13);
    EXPECT_LT(off_diagonal(sandwich(V, creeping.K)), 1e-12);
}

TEST(ModalBasis, DropsDependentColumns) {
    DenseMatrix U = scattered(n, p);
    U.col(5) = U.col(0) + U.col(2);
    EXPECT_EQ(modal_basis(chain(n), {U, {}}).U.cols(), p - 1);
    EXPECT_THROW(modal_basis(chain(n), {DenseMatrix::Zero(n, 2), {}}), InputError);
}

TEST(ModalBasis, OnlyOrthonormalisesWhereStiffnessIsNotSymmetric) {
    ContactProblem problem = chain(n);
    DenseMatrix K = problem.K.to_dense();
    K(0, 1) += 0.5;
    problem.K = Matrix(K);
    const DenseMatrix raw = scattered(n, p);
    const DenseMatrix U = modal_basis(problem, {raw, {}}).U;
    EXPECT_LT((U.transpose() * U - identity(p)).cwiseAbs().maxCoeff(), 1e-13);
    EXPECT_LT((projector(U) - projector(raw)).norm(), 1e-11);
}

TEST(Lift, MultipliesAndChecksSizes) {
    const ReducedBasis basis{scattered(n, p), scattered(n / 2, 3).cwiseAbs()};
    EXPECT_EQ(lift(basis, Vector::Unit(p, 2)), basis.U.col(2));
    EXPECT_EQ(lift_multipliers(basis, Vector::Unit(3, 1)), basis.U_lambda.col(1));
    EXPECT_THROW(lift(basis, Vector::Zero(p + 1)), InputError);
    EXPECT_THROW(lift_multipliers(basis, Vector::Zero(2)), InputError);
}

TEST(ReducedBasis, OfAnySignIsTakenOnlyWhereItSaysSo) {
    const ContactProblem problem = testing::chain(12);
    ReducedBasis basis{testing::scattered(12, 3), -DenseMatrix::Ones(problem.constraints(), 1)};
    EXPECT_THROW(validate(basis, problem), InputError);
    basis.signs = DualSigns::any;
    EXPECT_NO_THROW(validate(basis, problem));
    EXPECT_EQ(modal_basis(problem, basis).signs, DualSigns::any);
    basis.U_lambda(2, 0) = std::nan("");
    EXPECT_THROW(validate(basis, problem), InputError);
}

}  // namespace
}  // namespace tact
