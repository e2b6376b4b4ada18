#include "../../../contact/strategies/colour_sor.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <tuple>
#include <vector>

#include "../../../contact/strategies/colour_sweeps.hpp"

namespace tact {
namespace {

struct Membrane {
    SparseMatrix A;
    Vector b, lower, upper;
};

/// Five-point stencil with varying coefficients and a mass, unknowns numbered by `number`.
Membrane membrane(Index side, const std::vector<Index>& number) {
    const Index n = side * side;
    std::vector<Eigen::Triplet<double>> entries;
    Membrane m{SparseMatrix(n, n), Vector(n), Vector(n), Vector(n)};
    const auto at = [&](Index i, Index j) { return number[static_cast<std::size_t>(i + side * j)]; };
    const auto couple = [&](Index k, Index l, double a) {
        for (const auto& [row, column, value] : {std::tuple{k, k, a}, {l, l, a}, {k, l, -a}, {l, k, -a}})
            entries.emplace_back(row, column, value);
    };
    for (Index j = 0; j < side; ++j)
        for (Index i = 0; i < side; ++i) {
            const double x = static_cast<double>(i) / 7, y = static_cast<double>(j) / 5;
            entries.emplace_back(at(i, j), at(i, j), 2.5 + std::sin(x));
            if (i + 1 < side) couple(at(i, j), at(i + 1, j), 1 + 0.5 * std::sin(x * y));
            if (j + 1 < side) couple(at(i, j), at(i, j + 1), 1 + 0.5 * std::cos(x + y));
            m.b[at(i, j)] = 4 * std::sin(x) * std::cos(y);
            m.lower[at(i, j)] = -0.5 - 0.3 * std::cos(3 * x);
            m.upper[at(i, j)] = 0.4 + 0.3 * std::sin(2 * y);
        }
    m.A.setFromTriplets(entries.begin(), entries.end());
    return m;
}

std::vector<Index> numbers(Index n, unsigned seed) {
    std::vector<Index> order(static_cast<std::size_t>(n));
    std::iota(order.begin(), order.end(), Index{0});
    std::mt19937 random(seed);
    if (seed > 0) std::shuffle(order.begin(), order.end(), random);
    return order;
}

/// Gauss-Seidel on the plain rows until nothing moves.
Vector by_plain_sweeps(const Membrane& m, bool from_above) {
    Vector u = Vector::Zero(m.b.size());
    for (double change = 1; change > 0;) {
        change = 0;
        for (Index i = 0; i < u.size(); ++i) {
            double left = m.b[i];
            for (SparseMatrix::InnerIterator it(m.A, i); it; ++it)
                if (it.index() != i) left -= it.value() * u[it.index()];
            double next = std::max(left / m.A.coeff(i, i), m.lower[i]);
            if (from_above) next = std::min(next, m.upper[i]);
            // Below this a sweep only moves the last digit to and fro.
            if (std::abs(next - u[i]) > 1e-15) change = 1;
            u[i] = next;
        }
    }
    return u;
}

TEST(ColourSor, AgreesWithPlainGaussSeidelForLowerBoundsInAnyNumberingAndSize) {
    for (const Index side : {6, 16, 21, 32})
        for (const unsigned seed : {0U, 1U}) {
            const Membrane m = membrane(side, numbers(side * side, seed));
            const auto prepared = ColourSor().prepare(Matrix(m.A), Matrix::identity(side * side));
            Vector u = Vector::Zero(side * side), lambda = u;
            const auto report = prepared->solve(m.b, m.lower, {u, lambda});
            ASSERT_EQ(report.outcome, Outcome::converged);
            EXPECT_LE(report.kkt.largest(), 1e-12);
            const Vector plain = by_plain_sweeps(m, false);
            EXPECT_LE((u - plain).cwiseAbs().maxCoeff(), 1e-12);
            EXPECT_EQ(report.active, (plain.array() == m.lower.array()).count());
            for (Index i = 0; i < u.size(); ++i) EXPECT_TRUE(lambda[i] == 0 || u[i] == m.lower[i]);
            // From its own solution it has nothing left to do.
            const auto again = prepared->solve(m.b, m.lower, {u, lambda});
            EXPECT_EQ(again.outcome, Outcome::converged);
            EXPECT_EQ(again.iterations, 0);
        }
}

TEST(ColourSor, AgreesWithPlainGaussSeidelBetweenTwoBounds) {
    for (const unsigned seed : {0U, 1U}) {
        const Index side = 20, n = side * side;
        const Membrane m = membrane(side, numbers(n, seed));
        SparseMatrix B(2 * n, n);
        for (Index i = 0; i < n; ++i) {
            B.insert(i, i) = 2;
            B.insert(n + i, i) = -0.5;
        }
        Vector c(2 * n), u = Vector::Zero(n), lambda = Vector::Zero(2 * n);
        c << 2 * m.lower, -0.5 * m.upper;
        const auto report = ColourSor().prepare(Matrix(m.A), Matrix(B))->solve(m.b, c, {u, lambda});
        ASSERT_EQ(report.outcome, Outcome::converged);
        EXPECT_LE(report.kkt.largest(), 1e-12);
        EXPECT_GT((lambda.head(n).array() > 0).count(), 0);
        EXPECT_GT((lambda.tail(n).array() > 0).count(), 0);
        EXPECT_LE((u - by_plain_sweeps(m, true)).cwiseAbs().maxCoeff(), 1e-12);
    }
}

TEST(ColourSor, ReachesTheGoalOnRandomGraphsWithRowsOfAnyWeight) {
    std::mt19937 random(1);
    std::normal_distribution<double> normal;
    for (int trial = 0; trial < 1000; ++trial) {
        const auto draw = [&](Index below) { return static_cast<Index>(random() % static_cast<unsigned>(below)); };
        const Index n = 1 + draw(60), m = draw(2 * n + 1);
        DenseMatrix A = DenseMatrix::Zero(n, n), B = DenseMatrix::Zero(m, n);
        for (Index k = draw(5) * n; k > 0; --k) {
            const Index i = draw(n), j = draw(n);
            if (i != j) A(j, i) = A(i, j) += normal(random);
        }
        for (Index i = 0; i < n; ++i) A(i, i) = 1.02 * A.row(i).cwiseAbs().sum() + 0.05;
        Vector b(n), c(m), u = Vector::Zero(n), lambda = Vector::Zero(m);
        for (double& x : b) x = 5 * normal(random);
        for (Index i = 0; i < m; ++i) {
            B(i, draw(n)) = (draw(3) > 0 ? 1 : -1) * (0.1 + std::abs(normal(random)));
            c[i] = draw(5) == 0 ? -infinity : -std::abs(normal(random));
        }
        const auto report = ColourSor()
                                .prepare(Matrix(Matrix(A).to_sparse()), Matrix(Matrix(B).to_sparse()))
                                ->solve(b, c, {u, lambda});
        ASSERT_EQ(report.outcome, Outcome::converged) << "trial " << trial;
        ASSERT_LE(report.kkt.largest(), 1e-12) << "trial " << trial;
    }
}

TEST(ColourSor, TheScaleOfTheDataIsFree) {
    const Index side = 16;
    const Membrane m = membrane(side, numbers(side * side, 0));
    const auto prepared = ColourSor().prepare(Matrix(m.A), Matrix::identity(side * side));
    Vector reference = Vector::Zero(side * side);
    Vector lambda = reference;
    ASSERT_EQ(prepared->solve(m.b, m.lower, {reference, lambda}).outcome, Outcome::converged);
    for (const double scale : {1e-150, 1e-30, 1e30, 1e150}) {
        Vector u = Vector::Zero(side * side);
        const auto report = prepared->solve(scale * m.b, scale * m.lower, {u, lambda});
        ASSERT_EQ(report.outcome, Outcome::converged);
        EXPECT_LE((u / scale - reference).cwiseAbs().maxCoeff(), 1e-12);
    }
}

TEST(Places, WriteAndReadAreInverseWhateverTheOrder) {
    std::mt19937 random(3);
    std::vector<int> in_turns(50), in_order(50), shuffled(50);
    for (int i = 0; i < 50; ++i) {
        in_turns[static_cast<std::size_t>(i)] = i / 2 + (i % 2) * 32;
        in_order[static_cast<std::size_t>(i)] = i + 3;
        shuffled[static_cast<std::size_t>(i)] = i;
    }
    std::shuffle(shuffled.begin(), shuffled.end(), random);
    for (const auto& place : {in_turns, in_order, shuffled}) {
        const Places places(place);
        Padded<float> there;
        there.resize(64, -1);
        for (int s = 0; s < 4; ++s) {
            Places::Slice slice = {};
            for (int l = 0; l < 16; ++l) slice[l] = static_cast<float>(16 * s + l);
            places.write(s, slice, there.data());
        }
        for (int i = 0; i < 50; ++i) EXPECT_EQ(there[place[static_cast<std::size_t>(i)]], static_cast<float>(i));
        for (int s = 0; s < 4; ++s) {
            Places::Slice slice;
            places.read(s, there.data(), slice);
            for (int l = 0; l < 16 && 16 * s + l < 50; ++l) EXPECT_EQ(slice[l], static_cast<float>(16 * s + l));
        }
    }
}

}  // namespace
}  // namespace tact
