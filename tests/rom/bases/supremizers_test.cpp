#include "../../../rom/bases/supremizers.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <Eigen/SVD>

#include "../../../lib/errors.hpp"
#include "../../../rom/model/reduce.hpp"
#include "../chain.hpp"

namespace tact {
namespace {

using testing::chain;
using testing::scattered;

constexpr Index n = 24;

/// Eigen's dense factors, for sparse matrices too.
class AsDense final : public LinearSolver {
    std::unique_ptr<const Factor> factorize(const Matrix& A) const override {
        return DenseLinearSolver().factorize(Matrix(A.to_dense()));
    }
};

SupremizerOptions options(double a = 0) { return {.share = 0.2, .linear = std::make_shared<AsDense>(), .a = a}; }

TEST(Supremizers, AreTheAnswersToEachDualVector) {
    const ContactProblem problem = chain(n, -0.4, {.damping = true});
    DenseMatrix U_lambda = scattered(problem.constraints(), 4).cwiseAbs();
    U_lambda.col(2).setZero();
    for (const double a : {0.0, 3.0}) {
        const DenseMatrix A = a * a * problem.M->to_dense() + a * problem.D->to_dense() + problem.K.to_dense();
        DenseMatrix expected = A.inverse() * (problem.B.to_dense().transpose() * U_lambda);
        const DenseMatrix T = supremizers(problem, U_lambda, 9, options(a));
        ASSERT_EQ(T.cols(), 3);
        EXPECT_LT((T.col(2) - expected.col(3).normalized()).norm(), 1e-12);
        const DenseMatrix two = supremizers(problem, U_lambda, 2, options(a));
        expected = expected(Eigen::all, {0, 1, 3}).eval();
        expected.colwise().normalize();
        const Eigen::JacobiSVD<DenseMatrix> svd(expected, Eigen::ComputeThinU);
        const DenseMatrix leading = svd.matrixU().leftCols(2);
        ASSERT_EQ(two.cols(), 2);
        EXPECT_LT((leading - two * (two.transpose() * leading)).norm(), 1e-10);
    }
}

TEST(Supremizers, MakeReducedConstraintsIndependent) {
    const ContactProblem problem = chain(n);
    const DenseMatrix U_lambda = scattered(problem.constraints(), 5).cwiseAbs();
    DenseMatrix blind = scattered(n, 6);  // moves no row in contact
    for (Index i = 0; i < n; i += 2) blind.row(i).setZero();
    EXPECT_EQ(inf_sup_constant(reduce(problem, modal_basis(problem, {blind, U_lambda}))), 0);
    DenseMatrix U(n, 11);
    U << blind, supremizers(problem, U_lambda, 5, options());
    EXPECT_GT(inf_sup_constant(reduce(problem, modal_basis(problem, {U, U_lambda}))), 1e-6);
}

TEST(Supremizers, OfNothingAreNone) {
    const ContactProblem problem = chain(n);
    EXPECT_EQ(supremizers(problem, DenseMatrix(problem.constraints(), 0), 3, options()).cols(), 0);
    EXPECT_EQ(supremizers(problem, DenseMatrix::Ones(problem.constraints(), 2), 0, options()).cols(), 0);
    EXPECT_THROW((void)supremizers(problem, DenseMatrix::Ones(3, 2), 2, options()), InputError);
    EXPECT_THROW((void)supremizers(problem, DenseMatrix::Ones(problem.constraints(), 2), 2, {}), InputError);
}

}  // namespace
}  // namespace tact
