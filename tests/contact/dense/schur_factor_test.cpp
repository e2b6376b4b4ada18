// A factor that has been changed many times, against Eigen's of the rows it is left with.
#include "../../../contact/dense/schur_factor.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <numeric>
#include <random>

namespace tact {
namespace {

DenseMatrix spd(Index m, unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    const DenseMatrix C = DenseMatrix::NullaryExpr(m, m + 5, [&] { return normal(random); });
    return C * C.transpose();
}

/// S(C, C)^-1 x from the factor, its rows in rising order.
Vector solved(const SchurFactor& factor, const Vector& g) {
    const auto& rows = factor.rows();
    Vector x = g(rows);
    factor.solve(x);
    Vector all = Vector::Zero(g.size());
    for (std::size_t k = 0; k < rows.size(); ++k) all[rows[k]] = x[static_cast<Index>(k)];
    return all;
}

Vector solved_by_eigen(const DenseMatrix& S, const std::vector<Index>& rows, const Vector& g) {
    const DenseMatrix block = S(rows, rows);
    Vector all = Vector::Zero(g.size());
    const Vector part = g(rows);
    const Vector x = block.ldlt().solve(part);
    all(rows) = x;
    return all;
}

TEST(SchurFactor, ChangedManyTimesAgreesWithEigensLdlt) {
    for (const Index m : {5, 60, 200}) {
        std::mt19937 random(static_cast<unsigned>(m));
        const DenseMatrix S = spd(m, 3);
        const Vector g = Vector::LinSpaced(m, -1, 2);
        std::vector<char> in(static_cast<std::size_t>(m), 0);
        for (std::size_t i = 0; i < in.size(); i += 2) in[i] = 1;
        SchurFactor factor;
        int kept = 0;
        for (int k = 0; k < 200; ++k) {
            for (auto change = random() % 7; change-- > 0;) in[random() % in.size()] ^= 1;
            std::vector<Index> rows;
            for (Index i = 0; i < m; ++i)
                if (in[static_cast<std::size_t>(i)]) rows.push_back(i);
            kept += factor.change(S, rows);
            ASSERT_EQ(factor.size(), static_cast<Index>(rows.size()));
            const Vector expected = solved_by_eigen(S, rows, g);
            ASSERT_LE((solved(factor, g) - expected).norm(), 1e-9 * expected.norm()) << m << " rows, change " << k;
        }
        EXPECT_TRUE(m < 200 || kept > 50) << kept;
    }
}

TEST(SchurFactor, ChangedLeavesOutTheDependentRowsThatAFreshOneLeavesOut) {
    const Index m = 120;
    DenseMatrix S = spd(m, 7);
    // row 100 is row 3 again
    S.row(100) = S.row(3);
    S.col(100) = S.col(3);
    SchurFactor factor, fresh;
    std::vector<Index> rows(100);
    std::iota(rows.begin(), rows.end(), Index{0});
    (void)factor.change(S, rows);
    EXPECT_EQ(factor.size(), 100);
    rows.push_back(100);
    rows.push_back(101);
    (void)factor.change(S, rows);
    fresh.rebuild(S, rows);
    EXPECT_EQ(factor.rows(), fresh.rows());
    EXPECT_EQ(factor.size(), 101);
}

}  // namespace
}  // namespace tact
