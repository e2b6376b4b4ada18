#include "../../../rom/bases/nnmf.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "../../../rom/bases/nndsvd.hpp"
#include "../chain.hpp"

namespace tact {
namespace {

using testing::scattered;

/// Bumps that travel over `rows` places: what contact pressure looks like.
DenseMatrix fronts(Index rows, Index columns, double width) {
    DenseMatrix X = DenseMatrix::Zero(rows, columns);
    for (Index j = 0; j < columns; ++j) {
        const double centre = static_cast<double>(rows) * (0.5 + 0.4 * std::sin(0.13 * static_cast<double>(j)));
        for (Index i = 0; i < rows; ++i) {
            const double x = (static_cast<double>(i) - centre) / width;
            if (x * x < 1) X(i, j) = std::sqrt(1 - x * x);
        }
    }
    return X;
}

double relative(const DenseMatrix& X, const Nnmf& f) { return (X - f.U_lambda * f.V).norm() / X.norm(); }

/// Sparse and filled snapshots (products go over the entries, or are dense), and the three kinds of update.
struct Kind {
    double width;
    NnmfUpdates updates = NnmfUpdates::hierarchical;
    std::optional<RandomStarts> random = std::nullopt;
    NnmfOptions options() const {
        NnmfOptions result;
        result.updates = updates;
        result.random = random;
        return result;
    }
    friend void PrintTo(const Kind& kind, std::ostream* out) {
        constexpr const char* names[] = {"hierarchical", "multiplicative", "least squares"};
        *out << "width " << kind.width << ", " << names[static_cast<int>(kind.updates)];
        if (kind.random) *out << ", random starts";
    }
};

class NnmfOfKind : public ::testing::TestWithParam<Kind> {};

TEST_P(NnmfOfKind, NeverRaisesTheResidualItReports) {
    const DenseMatrix X = fronts(120, 80, GetParam().width);
    NnmfOptions options = GetParam().options();
    options.tolerance = 0;
    options.max_sweeps = 60;
    const Nnmf result = nnmf(X, 10, options);
    EXPECT_EQ(result.outcome, Outcome::iteration_limit);
    ASSERT_EQ(result.residuals.size(), 60u);
    for (std::size_t k = 1; k < result.residuals.size(); ++k)
        EXPECT_LE(result.residuals[k], result.residuals[k - 1] * (1 + 1e-13));
    EXPECT_NEAR(result.residuals.back(), relative(X, result), 1e-10);  // by definition, not by Gram matrices
}

TEST_P(NnmfOfKind, IsNonNegativeWithUnitColumns) {
    const Nnmf result = nnmf(fronts(120, 80, GetParam().width), 10, GetParam().options());
    // An exact minimum may need fewer vectors than its start has; those left out of it stay out.
    if (GetParam().updates != NnmfUpdates::least_squares) {
        ASSERT_EQ(result.U_lambda.cols(), 10);
    }
    EXPECT_GE(result.U_lambda.cols(), 8);
    EXPECT_GE(result.U_lambda.minCoeff(), 0);
    EXPECT_GE(result.V.minCoeff(), 0);
    EXPECT_LT((result.U_lambda.colwise().norm().array() - 1).abs().maxCoeff(), 1e-14);
}

TEST_P(NnmfOfKind, IsTheSameToTheLastBitEachTime) {
    const DenseMatrix X = fronts(500, 450, GetParam().width);  // beyond the size decomposed outright
    NnmfOptions options = GetParam().options();
    options.max_sweeps = 10;
    const Nnmf a = nnmf(X, 12, options), b = nnmf(X, 12, options);
    EXPECT_EQ(a.U_lambda, b.U_lambda);
    EXPECT_EQ(a.V, b.V);
    EXPECT_EQ(a.residuals, b.residuals);
}

INSTANTIATE_TEST_SUITE_P(Kinds, NnmfOfKind,
                         ::testing::Values(Kind{5.0}, Kind{60.0}, Kind{5.0, NnmfUpdates::multiplicative},
                                           Kind{60.0, NnmfUpdates::multiplicative},
                                           Kind{5.0, NnmfUpdates::least_squares},
                                           Kind{60.0, NnmfUpdates::least_squares},
                                           Kind{5.0, NnmfUpdates::hierarchical, RandomStarts{7, 2}}));

TEST(Nnmf, OfRankOneIsTheLeadingSingularPair) {
    const DenseMatrix X = scattered(20, 15).cwiseAbs();
    const Nnmf result = nnmf(X, 1);
    DenseMatrix power = X * X.transpose();  // its leading eigenvector by squaring
    for (int k = 0; k < 8; ++k) power = (power * power / power.squaredNorm()).eval();
    const Vector u = power.col(0).normalized();
    EXPECT_LT((result.U_lambda.col(0) - u).norm(), 1e-10);
}

TEST(Nnmf, RecoversASeparableMatrix) {
    // Each factor has a snapshot of its own and a row of its own: the factorisation is unique.
    const DenseMatrix noise = scattered(40, 4).cwiseAbs();
    DenseMatrix W = (noise.array() > 0.6).select(noise, 0), H = scattered(4, 30, 3).cwiseAbs();
    W.topRows(4) = testing::identity(4);
    H.leftCols(4) = testing::identity(4);
    const DenseMatrix X = W * H;
    NnmfOptions options;
    options.max_sweeps = 4000;
    options.tolerance = 0;
    for (const NnmfUpdates updates : {NnmfUpdates::hierarchical, NnmfUpdates::least_squares}) {
        options.updates = updates;
        const Nnmf result = nnmf(X, 4, options);
        EXPECT_LT(relative(X, result), 1e-5);
        // Every true column is there, up to scale and order.
        for (Index j = 0; j < 4; ++j) {
            const double alignment = (result.U_lambda.transpose() * W.col(j).normalized()).maxCoeff();
            EXPECT_GT(alignment, 1 - 1e-8);
        }
    }
}

TEST(Nnmf, KeepsTheBestOfItsRandomStarts) {
    const DenseMatrix X = fronts(60, 40, 8);
    NnmfOptions options;
    double lowest = infinity;
    for (std::uint64_t seed = 5; seed < 9; ++seed) {
        options.random = RandomStarts{seed, 1};
        lowest = std::min(lowest, nnmf(X, 6, options).residuals.back());
    }
    options.random = RandomStarts{5, 4};
    EXPECT_EQ(nnmf(X, 6, options).residuals.back(), lowest);
    options.random->count = 0;
    EXPECT_THROW(nnmf(X, 6, options), InputError);
}

TEST(Nnmf, LeavesZeroRowsAndColumnsZero) {
    DenseMatrix X = fronts(60, 40, 10);
    X.row(33).setZero();
    X.col(7).setZero();
    X.col(39).setZero();
    const Nnmf result = nnmf(X, 5);
    ASSERT_EQ(result.V.cols(), 40);
    EXPECT_EQ(result.U_lambda.row(33).norm(), 0);
    EXPECT_EQ(result.V.col(7).norm() + result.V.col(39).norm(), 0);
    EXPECT_GT(result.V.col(8).norm(), 0);
}

TEST(Nnmf, DropsColumnsBeyondTheRank) {
    const DenseMatrix X = scattered(20, 1).cwiseAbs() * scattered(1, 6, 2).cwiseAbs();
    const Nnmf result = nnmf(X, 3);
    EXPECT_EQ(result.U_lambda.cols(), 1);
    EXPECT_EQ(result.V.rows(), 1);
    EXPECT_LT(relative(X, result), 1e-12);
}

TEST(Nnmf, StopsWhenToldTo) {
    NnmfOptions options;
    options.tolerance = 0;
    options.observer = [](int sweep, double residual) { return residual > 0 && sweep < 3; };
    const Nnmf result = nnmf(fronts(60, 40, 10), 5, options);
    EXPECT_EQ(result.outcome, Outcome::stopped);
    EXPECT_EQ(result.residuals.size(), 3u);
}

TEST(Nnmf, NamesTheEntryItCannotTake) {
    const auto refusal = [](const DenseMatrix& X, Index rank) {
        try {
            nnmf(X, rank);
        } catch (const InputError& error) {
            return std::string(error.what());
        }
        return std::string("accepted");
    };
    DenseMatrix X = fronts(30, 20, 5);
    X(4, 11) = -1e-3;
    EXPECT_EQ(refusal(X, 3), "nnmf: X(4,11) is -0.001, expected a finite number >= 0");
    X(4, 11) = std::nan("");
    EXPECT_EQ(refusal(X, 3), "nnmf: X(4,11) is nan, expected a finite number >= 0");
    X(4, 11) = 0;
    X.col(0).setZero();
    EXPECT_EQ(refusal(X, 20), "nnmf: rank is 20, expected 1 to the number of non-zero snapshots, 19");
    EXPECT_EQ(refusal(X, 0), "nnmf: rank is 0, expected 1 to the number of non-zero snapshots, 19");
}

TEST(Nndsvd, IsNonNegativeAndAgreesBetweenItsTwoDecompositions) {
    // The same matrix, small enough to be decomposed outright, and padded with faint rows and columns until it is not.
    const DenseMatrix X = fronts(60, 50, 12) + DenseMatrix::Constant(60, 50, 0.01);
    DenseMatrix padded = DenseMatrix::Constant(450, 440, 1e-9);
    padded.topLeftCorner(60, 50) = X;
    const auto start = [](const DenseMatrix& A) { return nndsvd(NonNegativeBlock(SparseMatrix(A.sparseView())), 4); };
    const NonNegativePair small = start(X), large = start(padded);
    EXPECT_GE(small.W_transposed.minCoeff(), 0);
    EXPECT_GE(large.H_transposed.minCoeff(), 0);
    EXPECT_LT((small.W_transposed - large.W_transposed.leftCols(60)).norm(), 1e-4 * small.W_transposed.norm());
}

}  // namespace
}  // namespace tact
