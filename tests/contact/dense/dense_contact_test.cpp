#include "../../../contact/dense/dense_contact.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "../../../contact/dense/screened_gaps.hpp"
#include "../../scattered.hpp"

namespace tact {
namespace {

using testing::scattered;

constexpr Index p = 50, m = 30;
const Matrix A = Matrix::diagonal(Vector::LinSpaced(p, 1, 400).cwiseAbs2());
const Matrix B(scattered(m, p, 1));
const Vector c = Vector::Constant(m, -0.3);

/// A load that sways, so that contact comes and goes.
Vector load(int k) {
    const Vector shape = scattered(p, 1, 4).col(0);
    return 0.3 * std::sin(0.05 * k) * A.times(shape).cwiseProduct(Vector::LinSpaced(p, 1, 0.02).cwiseAbs2());
}

TEST(DenseContact, IsTheSameWithAndWithoutScreeningAndInFreeFlightToTheLastBit) {
    const auto with = DenseContact({.screening = true}).prepare(A, B);
    const auto without = DenseContact({.screening = false}).prepare(A, B);
    Vector u = Vector::Zero(p), v = u, lambda = Vector::Zero(m), mu = lambda;
    int open = 0, closed = 0;
    for (int k = 0; k < 400; ++k) {
        Vector bound = c;
        if (k % 3 == 0) bound[5] = -infinity;
        const ContactReport a = with->solve(load(k), bound, {u, lambda}), b = without->solve(load(k), bound, {v, mu});
        ASSERT_EQ(a.outcome, Outcome::converged);
        ASSERT_EQ(b.outcome, Outcome::converged);
        EXPECT_EQ(a.active, b.active);
        EXPECT_TRUE(((lambda.array() > 0) == (mu.array() > 0)).all());
        if (a.active > 0) {
            // A gap is summed in another order there, and rows enter in another one.
            ++closed;
            EXPECT_LT((u - v).norm(), 1e-13 * v.norm());
            EXPECT_LT((lambda - mu).norm(), 1e-12 * mu.norm());
            EXPECT_LT(a.kkt.largest(), 1e-13);
            continue;
        }
        ++open;
        EXPECT_EQ(u, v);
        EXPECT_EQ(a.iterations, b.iterations);
        EXPECT_EQ(a.kkt.stationarity, b.kkt.stationarity);
        EXPECT_EQ(a.kkt.penetration, b.kkt.penetration);
        EXPECT_EQ(a.kkt.negativity, b.kkt.negativity);
        EXPECT_EQ(a.kkt.complementarity, b.kkt.complementarity);
    }
    EXPECT_GT(open, 50);
    EXPECT_GT(closed, 50);
    Vector bad = load(1);
    bad[3] = std::nan("");
    lambda.setZero();
    EXPECT_EQ(with->solve(bad, c, {u, lambda}).outcome, Outcome::inaccurate);
}

/// Rows of a reduced model: 90 with the last 30 multiples of others or sums of two.
DenseMatrix many_rows(Index columns, double seed) {
    DenseMatrix rows = scattered(90, columns, seed);
    for (Index i = 60; i < 75; ++i) rows.row(i) = 2 * rows.row(i - 60);
    for (Index i = 75; i < 90; ++i) rows.row(i) = rows.row(i - 60) + rows.row(i - 30);
    return rows;
}

TEST(DenseContact, OnFewRowsAgreesWithAllRowsWhereRowsAreManyAndDependent) {
    std::mt19937 random(7);
    std::normal_distribution<double> normal;
    int closed = 0, open = 0;
    for (int model = 0; model < 12; ++model) {
        const double compliance = model % 2 ? 0.3 : 0;
        const Index n = model % 3 == 0 ? 40 : 110;
        const DenseMatrix rows = many_rows(n, 1 + 0.7 * model);
        const Matrix stiffness = Matrix::diagonal(Vector::LinSpaced(n, 1, 30).cwiseAbs2());
        const auto few = DenseContact({.compliance = compliance}).prepare(stiffness, Matrix(rows));
        const auto all =
            DenseContact({.compliance = compliance, .screening = false}).prepare(stiffness, Matrix(rows));
        // With compliance its forces press each row against its own spring.
        const Vector spring =
            compliance * (rows * stiffness.main_diagonal().cwiseInverse().asDiagonal() * rows.transpose()).diagonal();
        Vector u = Vector::Zero(n), v = u, lambda = Vector::Zero(90), mu = lambda, b = u;
        for (int k = 0; k < 60; ++k) {
            // Between steps the load changes little, and now and then altogether: cold and warm guesses.
            const double change = k % 20 == 0 ? 3 : 0.2;
            for (Index j = 0; j < n; ++j) b[j] = 0.9 * b[j] + change * normal(random) / static_cast<double>(j + 1);
            Vector bound = Vector::Constant(90, -0.5);
            bound.segment(60, 15) *= 2;
            bound.segment(75, 15) *= 2;
            if (k % 4 == 0) bound[model] = -infinity;
            const ContactReport a = few->solve(b, bound, {u, lambda}), e = all->solve(b, bound, {v, mu});
            ASSERT_EQ(a.outcome, Outcome::converged);
            ASSERT_EQ(e.outcome, Outcome::converged);
            ++(a.active > 0 ? closed : open);
            // Multipliers of dependent rows are any; the displacement is one.
            EXPECT_LT((u - v).norm(), 1e-11 * v.norm());
            if (compliance > 0) {
                EXPECT_LT((lambda - mu).norm(), 1e-11 * (1e-3 + mu.norm()));
            }
            const KktResiduals kkt =
                kkt_residuals(stiffness, Matrix(rows), b, bound - spring.cwiseProduct(lambda), u, lambda);
            EXPECT_LT(kkt.largest(), 1e-12);
        }
    }
    EXPECT_GT(closed, 300);
    EXPECT_GT(open, 30);
}

TEST(ScreenedGaps, ClaimsOnlyWhatHoldsInLongDouble) {
    const DenseMatrix rows = scattered(40, 60, 2);
    ScreenedGaps screen(rows);
    int claims = 0, open = 0;
    for (int k = 0; k < 2000; ++k) {
        Vector u = scattered(60, 1, 0.1 + 0.37 * k).col(0);
        for (Index j = 0; j < u.size(); ++j) u[j] /= static_cast<double>((j * 7) % 60 + 1) * (1 + k % 4);
        const Eigen::Matrix<long double, Eigen::Dynamic, 1> moved = rows.cast<long double>() * u.cast<long double>();
        Vector bound = Vector::Constant(40, -0.8);
        bound[k % 40] = k % 2 ? -infinity : static_cast<double>(moved[k % 40]);  // touching to rounding: never open
        const bool all = ((moved - bound.cast<long double>()).array() > 0).all();
        if (k % 2 == 0) {
            EXPECT_FALSE(screen.in_doubt(u, bound).empty());
        }
        if (k % 2 == 0) continue;
        open += all;
        if (!screen.in_doubt(u, bound).empty()) continue;
        ++claims;
        EXPECT_TRUE(all);
    }
    EXPECT_GT(open, 100);
    EXPECT_LT(open, 950);
    EXPECT_EQ(claims, open);  // rows in doubt are looked at in full
}

/// lambda of (S + E) lambda >= c - B A^-1 b and its complement, by projected Gauss-Seidel.
Vector by_gauss_seidel(const Vector& b, double compliance) {
    const DenseMatrix rows = B.to_dense();
    const Vector inverse = A.main_diagonal().cwiseInverse();
    DenseMatrix S = rows * inverse.asDiagonal() * rows.transpose();
    S.diagonal() *= 1 + compliance;
    const Vector g = c - rows * inverse.cwiseProduct(b);
    Vector lambda = Vector::Zero(m);
    for (int sweep = 0; sweep < 20000; ++sweep)
        for (Index i = 0; i < m; ++i) lambda[i] = std::max(lambda[i] + (g[i] - S.row(i).dot(lambda)) / S(i, i), 0.0);
    return lambda;
}

TEST(DenseContact, WithComplianceAgreesWithGaussSeidelOnTheSofterRows) {
    for (const double compliance : {0.1, 0.3, 2.0}) {
        const auto prepared = DenseContact({.compliance = compliance}).prepare(A, B);
        Vector u = Vector::Zero(p), lambda = Vector::Zero(m);
        int closed = 0;
        for (const int k : {5, 20, 31, 90}) {
            const ContactReport report = prepared->solve(load(k), c, {u, lambda});
            ASSERT_EQ(report.outcome, Outcome::converged);
            EXPECT_LT(report.kkt.largest(), 1e-12);
            const Vector expected = by_gauss_seidel(load(k), compliance);
            EXPECT_LT((lambda - expected).norm(), 1e-9 * (1 + expected.norm()));
            closed += report.active > 0;
            // The true penetration is that of the springs E, which the unchanged A balances.
            const DenseMatrix rows = B.to_dense();
            const Vector inverse = A.main_diagonal().cwiseInverse(), gap = rows * u - c;
            for (Index i = 0; i < m; ++i) {
                const double give = compliance * rows.row(i).cwiseAbs2().dot(inverse) * lambda[i];
                if (lambda[i] > 0) {
                    EXPECT_NEAR(gap[i], -give, 1e-12);
                }
                if (lambda[i] == 0) {
                    EXPECT_GE(gap[i], -1e-12);
                }
            }
            EXPECT_LT((A.times(u) - load(k) - rows.transpose() * lambda).norm(), 1e-9 * load(k).norm());
        }
        EXPECT_GE(closed, 2);
    }
}

TEST(DenseContact, WithComplianceSharesTheForceOfEqualRows) {
    DenseMatrix twice(2, 3);
    twice << 1, 0, 0, 1, 0, 0;
    const auto prepared = DenseContact({.compliance = 0.5}).prepare(Matrix::identity(3), Matrix(twice));
    Vector u = Vector::Zero(3), lambda = Vector::Zero(2);
    ASSERT_EQ(prepared->solve(Eigen::Vector3d(-5, 1, 2), Vector::Zero(2), {u, lambda}).outcome, Outcome::converged);
    EXPECT_NEAR(lambda[0], 2, 1e-12);  // -5 + 2 s + s/2 = 0
    EXPECT_NEAR(lambda[1], 2, 1e-12);
    EXPECT_NEAR(u[0], -1, 1e-12);
}

TEST(DenseContact, RefusesAComplianceThatIsNone) {
    for (const double bad : {-0.1, std::nan(""), infinity})
        EXPECT_THROW((void)DenseContact({.compliance = bad}).prepare(A, B), InputError);
}

/// Rows that touch a ball's polyhedron: whatever is pushed, few of thousands can hold it. Against the same solve on the rows
/// that are nearest alone, where S is formed.
TEST(DenseContact, FormsNothingOfManyRowsThatTheyDoNotNeed) {
    std::mt19937 random(5);
    std::normal_distribution<double> normal;
    const Index n = 6, count = 5000, near = 1000;
    DenseMatrix rows_of_ball = DenseMatrix::NullaryExpr(count, n, [&] { return normal(random); });
    rows_of_ball.rowwise().normalize();
    const DenseMatrix G = DenseMatrix::NullaryExpr(n, n, [&] { return normal(random); });
    const Matrix stiffness(DenseMatrix(G * G.transpose() + DenseMatrix::Identity(n, n)));
    const Vector radius = Vector::Constant(count, -1);
    const auto prepared = DenseContact().prepare(stiffness, Matrix(rows_of_ball));
    Vector u = Vector::Zero(n), lambda = Vector::Zero(count);
    for (int k = 0; k < 10; ++k) {
        const Vector b = Vector::NullaryExpr(n, [&] { return 20 * normal(random); });
        const auto report = prepared->solve(b, radius, {u, lambda});
        ASSERT_EQ(report.outcome, Outcome::converged);
        EXPECT_GE((rows_of_ball * u - radius).minCoeff(), -1e-12);
        const Vector gap = rows_of_ball * u - radius;
        std::vector<Index> rows(static_cast<std::size_t>(count));
        std::iota(rows.begin(), rows.end(), 0);
        std::sort(rows.begin(), rows.end(), [&](Index i, Index j) { return gap[i] < gap[j]; });
        rows.resize(near);
        Vector other_u = Vector::Zero(n), other = Vector::Zero(near);
        ASSERT_EQ(DenseContact()
                      .prepare(stiffness, Matrix(DenseMatrix(rows_of_ball(rows, Eigen::all))))
                      ->solve(b, Vector::Constant(near, -1), {other_u, other})
                      .outcome,
                  Outcome::converged);
        EXPECT_LE((u - other_u).norm(), 1e-11 * u.norm());
        EXPECT_GT(report.active, 0);
    }
}

}  // namespace
}  // namespace tact
