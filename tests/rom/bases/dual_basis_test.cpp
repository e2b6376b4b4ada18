#include "../../../rom/bases/dual_basis.hpp"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <Eigen/SVD>
#include <cmath>

#include "../chain.hpp"

namespace tact {
namespace {

using testing::scattered;

constexpr Index n = 60, m = 30;

/// Fronts over rows 5 to 20 of 30; columns 0 and 7 are zero.
DenseMatrix fronts() {
    DenseMatrix X = DenseMatrix::Zero(m, 25);
    for (Index j = 1; j < X.cols(); ++j) {
        if (j == 7) continue;
        const double centre = 12 + 5 * std::sin(0.4 * static_cast<double>(j));
        for (Index i = 5; i <= 20; ++i) {
            const double x = (static_cast<double>(i) - centre) / 3;
            if (x * x < 1) X(i, j) = 2 * std::sqrt(1 - x * x);
        }
    }
    return X;
}

DualBasisResult made(const DualBasis& recipe, const DenseMatrix& X, Index size,
                     const DenseMatrix& U = scattered(n, 12)) {
    SparseMatrix B(m, n);
    for (Index i = 0; i < m; ++i) B.insert(i, 2 * i) = 1;
    const SparseMatrix snapshots = X.sparseView();
    return recipe({snapshots, Matrix(B), U, size});
}

struct Named {
    const char* name;
    DualBasis recipe;
    bool compresses = true;  // gives at most as many columns as asked
    friend void PrintTo(const Named& basis, std::ostream* out) { *out << basis.name; }
};

NnmfOptions with(NnmfUpdates updates, std::optional<RandomStarts> random = std::nullopt) {
    NnmfOptions options;
    options.updates = updates;
    options.random = random;
    return options;
}

class EachDualBasis : public ::testing::TestWithParam<Named> {};

TEST_P(EachDualBasis, IsAsItPromises) {
    const DenseMatrix X = fronts();
    for (const Index size : {1, 3, 8, 500}) {
        const DualBasisResult result = made(GetParam().recipe, X, size);
        ASSERT_EQ(result.U_lambda.rows(), m);
        ASSERT_GT(result.U_lambda.cols(), 0) << size;
        EXPECT_LE(result.U_lambda.cols(), GetParam().compresses ? std::min<Index>(size, 23) : 16);
        EXPECT_TRUE(result.U_lambda.allFinite());
        if (result.signs == DualSigns::non_negative) {
            EXPECT_GE(result.U_lambda.minCoeff(), 0);
        }
        EXPECT_LT((result.U_lambda.colwise().norm().array() - 1).abs().maxCoeff(), 1e-13);
        for (Index i = 0; i < m; ++i)
            if (X.row(i).isZero(0)) {
                EXPECT_EQ(result.U_lambda.row(i).norm(), 0) << i;
            }
    }
}

TEST_P(EachDualBasis, IsTheSameToTheLastBitEachTime) {
    EXPECT_EQ(made(GetParam().recipe, fronts(), 6).U_lambda, made(GetParam().recipe, fronts(), 6).U_lambda);
}

TEST_P(EachDualBasis, OfNothingHasNoColumns) {
    for (const DenseMatrix& X : {DenseMatrix(DenseMatrix::Zero(m, 4)), DenseMatrix(m, 0)}) {
        const DualBasisResult result = made(GetParam().recipe, X, 3);
        EXPECT_EQ(result.U_lambda.rows(), m);
        EXPECT_EQ(result.U_lambda.cols(), 0);
        EXPECT_TRUE(result.warning.empty());
    }
    if (GetParam().compresses) {
        EXPECT_EQ(made(GetParam().recipe, fronts(), 0).U_lambda.cols(), 0);
    }
}

TEST_P(EachDualBasis, TakesOneColumnAndManyEqualOnes) {
    const Vector x = fronts().col(3);
    for (const Index copies : {1, 6}) {
        const DualBasisResult result = made(GetParam().recipe, x.replicate(1, copies), 4);
        ASSERT_GT(result.U_lambda.cols(), 0);
        // The snapshot lies in the span: by least squares, whatever the recipe did.
        const Vector fit = result.U_lambda * result.U_lambda.completeOrthogonalDecomposition().solve(x);
        if (GetParam().name != std::string("selected rows")) {
            EXPECT_LT((fit - x).norm(), 1e-7 * x.norm());
        }
        EXPECT_TRUE(result.warning.empty()) << result.warning;
    }
}

TEST_P(EachDualBasis, NamesWhatItCannotTake) {
    DenseMatrix X = fronts();
    X(12, 3) = -1;
    EXPECT_THROW((void)made(GetParam().recipe, X, 3), InputError);
    X(12, 3) = std::nan("");
    EXPECT_THROW((void)made(GetParam().recipe, X, 3), InputError);
    EXPECT_THROW((void)made(GetParam().recipe, DenseMatrix::Zero(m + 1, 3), 3), InputError);
    EXPECT_THROW((void)made(GetParam().recipe, fronts(), 3, scattered(n + 1, 2)), InputError);
    EXPECT_THROW((void)made(GetParam().recipe, fronts(), -1), InputError);
}

INSTANTIATE_TEST_SUITE_P(
    Recipes, EachDualBasis,
    ::testing::Values(Named{"snapshot cone", snapshot_cone()}, Named{"nnmf", nnmf_basis()},
                      Named{"multiplicative", nnmf_basis(with(NnmfUpdates::multiplicative))},
                      Named{"least squares", nnmf_basis(with(NnmfUpdates::least_squares))},
                      Named{"random", nnmf_basis(with(NnmfUpdates::hierarchical, RandomStarts{3, 4}))},
                      Named{"cone-projected greedy", cone_projected_greedy()},
                      Named{"selected rows", selected_rows()}, Named{"touched rows", touched_rows(), false},
                      Named{"singular vectors", singular_vectors()}),
    [](const auto& each) {
        std::string name = each.param.name;
        std::erase_if(name, [](char c) { return !std::isalnum(static_cast<unsigned char>(c)); });
        return name;
    });

TEST(ConeProjectedGreedy, ChoosesTheExtremeRaysAndStops) {
    // Every snapshot is a non-negative combination of four of them: the cone is full with those.
    DenseMatrix X = DenseMatrix::Zero(m, 20);
    const DenseMatrix rays = scattered(10, 4).cwiseAbs(), weights = scattered(4, 16, 2).cwiseAbs() / 4;
    X.block(3, 2, 10, 4) = rays;
    X.block(3, 0, 10, 2) = rays * weights.leftCols(2);
    X.block(3, 6, 10, 14) = rays * weights.rightCols(14);
    const DualBasisResult result = made(cone_projected_greedy(1e-6), X, 20);
    ASSERT_EQ(result.U_lambda.cols(), 4);
    const DenseMatrix aligned = result.U_lambda.transpose() * X.middleCols(2, 4).colwise().normalized();
    EXPECT_GT(aligned.colwise().maxCoeff().minCoeff(), 1 - 1e-12);
    for (std::size_t k = 1; k < result.residuals.size(); ++k) EXPECT_LE(result.residuals[k], result.residuals[k - 1]);
}

TEST(SelectedRows, AreThePivotsOfGramSchmidtOnTheTouchedRows) {
    // Told by projections on what was chosen, from scratch each time.
    const DenseMatrix U = scattered(n, 5), X = fronts();
    const DualBasisResult result = made(selected_rows(), X, 5, U);
    ASSERT_EQ(result.U_lambda.cols(), 5);
    DenseMatrix chosen(5, 0);
    for (Index k = 0; k < 5; ++k) {
        Index best = -1;
        double longest = 0;
        for (Index i = 0; i < m; ++i) {
            if (X.row(i).isZero(0)) continue;
            Vector left = U.row(2 * i).transpose();
            if (k > 0) left -= chosen * chosen.completeOrthogonalDecomposition().solve(left);
            if (left.norm() > longest) {
                longest = left.norm();
                best = i;
            }
        }
        EXPECT_EQ(result.U_lambda(best, k), 1);
        chosen.conservativeResize(5, k + 1);
        chosen.col(k) = U.row(2 * best).transpose();
    }
}

TEST(SelectedRows, CountMirroredPairsOnceAndFillBeyondTheRank) {
    DenseMatrix U = scattered(n, 3);
    for (Index i = 0; i < 30; ++i)
        U.row(59 - i - 1) = U.row(i);  // rows 2i and 58 - 2i of U: rows i and 29 - i of B U
    const DenseMatrix X = DenseMatrix::Ones(m, 2);
    const DualBasisResult result = made(selected_rows(), X, 500, U);
    EXPECT_EQ(result.U_lambda.cols(), 15);
    for (Index i = 0; i < m / 2; ++i) EXPECT_EQ(result.U_lambda.row(i).sum() + result.U_lambda.row(29 - i).sum(), 1);
    EXPECT_EQ(made(selected_rows(), X, 7, U).U_lambda.cols(), 7);
}

TEST(SingularVectors, SpanTheSpaceOfADenseSvdAndSaySo) {
    const DenseMatrix X = fronts();
    const DualBasisResult result = made(singular_vectors(), X, 4);
    EXPECT_EQ(result.signs, DualSigns::any);
    EXPECT_LT(result.U_lambda.minCoeff(), 0);
    const Eigen::JacobiSVD<DenseMatrix> svd(X, Eigen::ComputeThinU);
    const DenseMatrix U = svd.matrixU().leftCols(4);
    EXPECT_LT((U - result.U_lambda * (result.U_lambda.transpose() * U)).norm(), 1e-9);
}

TEST(DualBasis, WarnsWhereSnapshotsCompressBadlyAndOnlyThere) {
    DenseMatrix moving = DenseMatrix::Zero(m, m);  // a point that travels: no two snapshots overlap
    moving.diagonal().setOnes();
    EXPECT_EQ(
        made(nnmf_basis(), moving, 15).warning,
        "the dual snapshots compress badly: the best 15 vectors leave 71 % of their norm; take more, or contact "
        "at selected rows");
    const DenseMatrix two = scattered(m, 2).cwiseAbs() * scattered(2, 12, 4).cwiseAbs();
    EXPECT_TRUE(made(nnmf_basis(), two, 2).warning.empty());
}

TEST(DualBasis, StopsWhenToldTo) {
    SparseMatrix B(m, n);
    B.setZero();
    const SparseMatrix X = fronts().sparseView();
    for (const DualBasis& recipe : {nnmf_basis(), cone_projected_greedy()}) {
        int told = 0;
        const DualBasisResult result = recipe({X, Matrix(B), scattered(n, 2), 6, [&](double fraction) {
                                                   EXPECT_GT(fraction, 0);
                                                   return ++told < 2;
                                               }});
        EXPECT_EQ(result.outcome, Outcome::stopped);
        EXPECT_EQ(told, 2);
    }
}

}  // namespace
}  // namespace tact
