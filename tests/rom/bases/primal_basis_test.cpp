#include "../../../rom/bases/primal_basis.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/SVD>

#include "../../../contact/dense/dense_contact.hpp"
#include "../../../lib/errors.hpp"
#include "../../../lib/time/stage.hpp"
#include "../../../rom/bases/compressed_basis.hpp"
#include "../../../rom/model/reduce.hpp"
#include "../chain.hpp"

namespace tact {
namespace {

using testing::chain;
using testing::identity;
using testing::scattered;

constexpr Index n = 30;

/// Snapshots of two bodies, unknowns 0 to 11 and 12 to 29; the first moves `ratio` times as much.
DenseMatrix of_two_bodies(double ratio) {
    DenseMatrix X = scattered(n, 8) * Vector::LinSpaced(8, 1, 0.1).asDiagonal() * scattered(8, 20, 2);
    X.topRows(12) *= ratio;
    return X;
}

std::vector<Index> two_bodies() {
    std::vector<Index> body_of(n, 1);
    std::fill(body_of.begin(), body_of.begin() + 12, 0);
    return body_of;
}

PodAccumulator accumulated(const DenseMatrix& X, std::optional<Matrix> W = std::nullopt) {
    PodAccumulator snapshots({.inner_product = std::move(W)});
    snapshots.add(X.leftCols(X.cols() / 2));
    snapshots.add(X.rightCols(X.cols() - X.cols() / 2));
    return snapshots;
}

Matrix stiffness() { return chain(n).K; }

TEST(PrimalBasis, OfBodiesIsTheBestOfItsSizeBodyByBodyAgainstJacobiSvd) {
    const DenseMatrix X = of_two_bodies(0.6);
    const Eigen::JacobiSVD<DenseMatrix> first(X.topRows(12), Eigen::ComputeThinU),
        second(X.bottomRows(18), Eigen::ComputeThinU);
    const DenseMatrix U = primal_basis(accumulated(X), 6, 0, {two_bodies(), {}});
    ASSERT_EQ(U.cols(), 6);
    EXPECT_LT((U.transpose() * U - identity(6)).norm(), 1e-12);
    // Of all singular values of both the six largest.
    Vector both(first.singularValues().size() + second.singularValues().size());
    both << first.singularValues(), second.singularValues();
    std::sort(both.begin(), both.end(), std::greater<>());
    EXPECT_NEAR((X - U * (U.transpose() * X)).norm(), both.tail(both.size() - 6).norm(), 1e-8);
    Index of_first = 0;
    for (Index j = 0; j < 6; ++j) {
        const bool moves_first = !U.col(j).head(12).isZero(0), moves_second = !U.col(j).tail(18).isZero(0);
        EXPECT_NE(moves_first, moves_second);
        of_first += moves_first;
    }
    EXPECT_GT(of_first, 0);
    EXPECT_LT(of_first, 3);
}

TEST(PrimalBasis, GivesABodyThatRestsNoModesAndNoMoreThanThereAre) {
    const DenseMatrix X = of_two_bodies(0);
    const DenseMatrix U = primal_basis(accumulated(X), 20, 0, {two_bodies(), {}});
    ASSERT_EQ(U.cols(), 8);
    EXPECT_TRUE(U.topRows(12).isZero(0));
    EXPECT_EQ(primal_basis(accumulated(of_two_bodies(1)), 20, 0, {two_bodies(), {}}).cols(), 16);
    EXPECT_EQ(primal_basis(accumulated(DenseMatrix::Zero(n, 4)), 2, 0, {two_bodies(), {}}).cols(), 0);
    EXPECT_EQ(primal_basis(accumulated(X.leftCols(1)), 1, 0, {two_bodies(), {}}).cols(), 1);
}

TEST(PrimalBasis, OfOneBodyIsThePodOfAll) {
    const PodAccumulator snapshots = accumulated(of_two_bodies(0.5));
    const DenseMatrix joint = primal_basis(snapshots, 5, 0),
                      one = primal_basis(snapshots, 5, 0, {std::vector<Index>(n, 0), {}});
    EXPECT_EQ(joint, snapshots.modes(5).modes);
    EXPECT_LT((joint - one).norm(), 1e-9);
}

TEST(PrimalBasis, BodiesAreTheConnectedPartsOfK) {
    SparseMatrix K(6, 6);
    for (const auto& [i, j] : {std::pair{0, 4}, std::pair{4, 2}, std::pair{1, 5}})
        K.insert(i, j) = K.insert(j, i) = -1;
    for (Index i = 0; i < 6; ++i) K.insert(i, i) = 4;
    EXPECT_EQ(connected_bodies(Matrix(K)), (std::vector<Index>{0, 1, 0, 2, 0, 1}));
    EXPECT_EQ(connected_bodies(stiffness()), std::vector<Index>(n, 0));
}

TEST(PrimalBasis, HoldsWhatIsGivenAndThePodOfTheRestInEachInnerProductAgainstJacobiSvd) {
    const DenseMatrix X = of_two_bodies(1), given = scattered(n, 2, 5);
    for (const std::optional<Matrix>& W :
         {std::optional<Matrix>(), std::optional(Matrix::diagonal(Vector::LinSpaced(n, 1, 2))),
          std::optional(stiffness())}) {
        const DenseMatrix root = Eigen::LLT<DenseMatrix>(W ? W->to_dense() : identity(n)).matrixU();
        DenseMatrix U = root * primal_basis(accumulated(X, W), 4, 0, {{}, given});  // in coordinates where W is I
        ASSERT_EQ(U.cols(), 6);
        EXPECT_LT((U.transpose() * U - identity(6)).norm(), 1e-10);
        const DenseMatrix held = root * given;
        EXPECT_LT((held - U * (U.transpose() * held)).norm(), 1e-10);
        const DenseMatrix Q = Eigen::JacobiSVD<DenseMatrix>(held, Eigen::ComputeThinU).matrixU();
        const DenseMatrix all = root * X, rest = all - Q * (Q.transpose() * all);
        const Vector sigma = Eigen::JacobiSVD<DenseMatrix>(rest).singularValues();
        EXPECT_NEAR((all - U * (U.transpose() * all)).norm(), sigma.tail(sigma.size() - 4).norm(), 1e-8);
    }
}

TEST(PrimalBasis, HoldsThePartsOfWhatIsGivenInEachBody) {
    const DenseMatrix U = primal_basis(accumulated(of_two_bodies(1)), 3, 0, {two_bodies(), scattered(n, 2, 5)});
    EXPECT_EQ(U.cols(), 7);
    DenseMatrix part = DenseMatrix::Zero(n, 1);
    part.topRows(12) = scattered(n, 2, 5).topRows(12).col(1);
    EXPECT_LT((part - U * (U.transpose() * part)).norm(), 1e-12);
}

TEST(PrimalBasis, AllHeldLeavesNothingToPod) {
    const DenseMatrix X = scattered(n, 3) * scattered(3, 10, 2);
    EXPECT_EQ(primal_basis(accumulated(X), 5, 0, {{}, X.leftCols(3)}).cols(), 3);
}

TEST(PrimalBasis, RefusesOptionsThatDoNotFit) {
    const PodAccumulator snapshots = accumulated(of_two_bodies(1));
    EXPECT_THROW((void)primal_basis(snapshots, 21, 0, {two_bodies(), {}}), InputError);
    EXPECT_THROW((void)primal_basis(snapshots, 3, 0, {{0, 1}, {}}), InputError);
    EXPECT_THROW((void)primal_basis(snapshots, 3, 0, {std::vector<Index>(n, -1), {}}), InputError);
    EXPECT_THROW((void)primal_basis(snapshots, 3, 0, {{}, identity(3)}), InputError);
    EXPECT_THROW((void)primal_basis(snapshots, 3, 0, {{}, DenseMatrix::Constant(n, 1, std::nan(""))}), InputError);
}

/// Eigen's dense factors, for sparse matrices too.
class AsDense final : public LinearSolver {
    std::unique_ptr<const Factor> factorize(const Matrix& A) const override {
        return DenseLinearSolver().factorize(Matrix(A.to_dense()));
    }
};

TEST(StaticModes, MakeStaticAnswersToTheirForcesExact) {
    ContactProblem problem = chain(n, -2, {.mass = false, .moving_load = false});
    const std::vector<Index> rows{3, 7};
    const DenseMatrix modes = static_modes(problem, rows, AsDense());
    ASSERT_EQ(modes.cols(), 3);
    EXPECT_LT((modes.colwise().norm().array() - 1).abs().maxCoeff(), 1e-14);
    const DenseMatrix U = primal_basis(accumulated(of_two_bodies(1)), 2, 0, {{}, modes});
    const ContactProblem reduced = reduce(problem, ReducedBasis{U, DenseMatrix(problem.constraints(), 0)});
    const DenseMatrix K = problem.K.to_dense(), B = problem.B.to_dense();
    const Vector force = 2 * problem.f.at(0) + 0.7 * B.row(3).transpose() - 3 * B.row(7).transpose();
    const Vector q = reduced.K.to_dense().inverse() * (U.transpose() * force);
    EXPECT_LT((U * q - K.inverse() * force).norm(), 1e-11);
}

TEST(StaticModes, OfNoLoadAndNoRowsAreNone) {
    ContactProblem problem = chain(n);
    problem.f.modes.setZero();
    EXPECT_EQ(static_modes(problem, {}, AsDense()).cols(), 0);
    EXPECT_THROW((void)static_modes(problem, {problem.constraints()}, AsDense()), InputError);
    EXPECT_THROW((void)static_modes(problem, {-1}, AsDense()), InputError);
}

}  // namespace
}  // namespace tact
