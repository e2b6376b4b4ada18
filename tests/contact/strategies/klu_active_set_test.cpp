#include "../../../contact/strategies/klu_active_set.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <random>

#include "../../../contact/automatic.hpp"
#include "../../../contact/dense/unsymmetric_active_set.hpp"
#include "../../../contact/strategies/lemke.hpp"

namespace tact {
namespace {

using Triplet = Eigen::Triplet<double, long>;

struct Obstacle {
    Matrix A, B;
    Vector b, c;
};

/// -u'' + Pe u' >= f, u >= psi on (0,1), upwind: a tridiagonal M-matrix that is not symmetric.
Obstacle line(Index n, double peclet, double waves) {
    const double h = 1 / static_cast<double>(n + 1);
    std::vector<Triplet> entries;
    Obstacle o{{}, Matrix::identity(n), Vector(n), Vector(n)};
    for (Index i = 0; i < n; ++i) {
        const double x = static_cast<double>(i + 1) * h;
        entries.emplace_back(i, i, 2 / h / h + peclet / h);
        if (i > 0) entries.emplace_back(i, i - 1, -1 / h / h - peclet / h);
        if (i + 1 < n) entries.emplace_back(i, i + 1, -1 / h / h);
        o.c[i] = -0.05 - 0.02 * std::sin(waves * x);
        o.b[i] = -5 * (1 + peclet) * std::sin(3 * x);
    }
    SparseMatrix A(n, n);
    A.setFromTriplets(entries.begin(), entries.end());
    o.A = Matrix(A);
    return o;
}

/// Convection and diffusion on a k x k square; `mixed` adds a cross derivative, whose positive couplings leave no M-matrix.
Obstacle square(Index k, double wind, double mixed) {
    const Index n = k * k;
    const double h = 1 / static_cast<double>(k + 1);
    std::vector<Triplet> entries;
    Obstacle o{{}, Matrix::identity(n), Vector(n), Vector(n)};
    for (Index i = 0; i < k; ++i)
        for (Index j = 0; j < k; ++j) {
            const Index row = i * k + j;
            const double x = static_cast<double>(i + 1) * h, y = static_cast<double>(j + 1) * h;
            const double wx = wind * std::cos(3 * y), wy = wind * std::sin(5 * x);
            const auto add = [&](Index p, Index q, double value) {
                if (p >= 0 && p < k && q >= 0 && q < k) entries.emplace_back(row, p * k + q, value * h * h);
            };
            add(i, j, 4 / h / h + (std::abs(wx) + std::abs(wy)) / h);
            add(i - 1, j, -1 / h / h - std::max(wx, 0.0) / h);
            add(i + 1, j, -1 / h / h - std::max(-wx, 0.0) / h);
            add(i, j - 1, -1 / h / h - std::max(wy, 0.0) / h);
            add(i, j + 1, -1 / h / h - std::max(-wy, 0.0) / h);
            for (const int s : {-1, 1}) {
                add(i + s, j + s, -mixed / (2 * h * h));
                add(i + s, j - s, mixed / (2 * h * h));
            }
            o.c[row] = -0.03 - 0.02 * std::sin(9 * x) * std::cos(7 * y);
            o.b[row] = -8 * (1 + 0.3 * wind) * std::sin(3 * x) * h * h;
        }
    SparseMatrix A(n, n);
    A.setFromTriplets(entries.begin(), entries.end());
    o.A = Matrix(A);
    return o;
}

/// The four conditions in long double from the data alone: with x'Ax > 0 they have one solution.
void expect_solution(const Obstacle& o, const Vector& u, const Vector& lambda, double tolerance) {
    const SparseMatrix A = o.A.to_sparse(), B = o.B.to_sparse();
    std::vector<long double> force(static_cast<std::size_t>(u.size()), 0), size = force;
    std::vector<long double> gap(static_cast<std::size_t>(lambda.size()), 0);
    for (Index j = 0; j < u.size(); ++j) {
        force[static_cast<std::size_t>(j)] -= o.b[j];
        size[static_cast<std::size_t>(j)] += std::abs(o.b[j]);
        for (SparseMatrix::InnerIterator it(A, j); it; ++it) {
            const long double term = static_cast<long double>(it.value()) * u[j];
            force[static_cast<std::size_t>(it.row())] += term;
            size[static_cast<std::size_t>(it.row())] += std::abs(term);
        }
        for (SparseMatrix::InnerIterator it(B, j); it; ++it) {
            force[static_cast<std::size_t>(j)] -= static_cast<long double>(it.value()) * lambda[it.row()];
            gap[static_cast<std::size_t>(it.row())] += static_cast<long double>(it.value()) * u[j];
        }
    }
    const auto largest = *std::max_element(size.begin(), size.end());
    const long double reach =
        o.c.array().isFinite().select(o.c, 0).lpNorm<Eigen::Infinity>() + u.lpNorm<Eigen::Infinity>();
    for (const long double f : force) EXPECT_LE(std::abs(f), tolerance * largest);
    for (Index i = 0; i < lambda.size(); ++i) {
        EXPECT_GE(lambda[i], 0);
        if (o.c[i] == -infinity) continue;
        const long double open = gap[static_cast<std::size_t>(i)] - o.c[i];
        EXPECT_GE(open, -tolerance * reach);
        EXPECT_TRUE(lambda[i] == 0 || open <= tolerance * reach);
    }
}

TEST(KluActiveSet, NeedsNoMoreSetsOnAFinerGrid) {
    for (const double peclet : {1.0, 100.0})
        for (const double waves : {20.0, 90.0})
            for (const Index n : {500, 4000, 32000}) {
                const Obstacle o = line(n, peclet, waves);
                Vector u = Vector::Zero(n), lambda = Vector::Zero(n);
                const auto report = KluActiveSet().prepare(o.A, o.B)->solve(o.b, o.c, {u, lambda});
                ASSERT_EQ(report.outcome, Outcome::converged);
                EXPECT_LE(report.iterations, 8);
                expect_solution(o, u, lambda, 1e-12);
            }
    for (const double mixed : {0.0, 0.9})
        for (const Index k : {20, 40, 80}) {
            const Obstacle o = square(k, 10, mixed);
            Vector u = Vector::Zero(k * k), lambda = u;
            const auto report = AutomaticContact().prepare(o.A, o.B)->solve(o.b, o.c, {u, lambda});
            ASSERT_EQ(report.outcome, Outcome::converged);
            EXPECT_TRUE(report.fallback.empty());
            EXPECT_LE(report.iterations, 8);
            expect_solution(o, u, lambda, 1e-12);
        }
}

/// Implicit Euler, consistent mass: u_t = u_xx + f on (0,10), f = -1 | +1, dt = 1, u(0) = 0, u(10) = 10, u(x,0) = x. (A
/// problem of MOOSE's, issue 14166, where the iterations of the second step double with the grid.)
TEST(KluActiveSet, FollowsAFrontOnAnyGridFromBelowAndFromAbove) {
    for (const bool both : {false, true})
        for (const Index cells : {100, 1600, 25600}) {
            const Index n = cells - 1, rows = both ? 2 * n : n;
            const double h = 10 / static_cast<double>(cells);
            std::vector<Triplet> stiffness, mass, constraints;
            Obstacle o{{}, {}, Vector(n), Vector::Zero(rows)};
            Vector load(n), u(n), lambda = Vector::Zero(rows);
            for (Index i = 0; i < n; ++i) {
                const double x = static_cast<double>(i + 1) * h;
                for (Index j = std::max<Index>(i - 1, 0); j <= std::min(i + 1, n - 1); ++j) {
                    mass.emplace_back(i, j, (i == j ? 4 : 1) * h / 6);
                    stiffness.emplace_back(i, j, (i == j ? 4 : 1) * h / 6 + (i == j ? 2 : -1) / h);
                }
                load[i] = (2 * (i + 1) == cells ? 0 : x < 5 ? -h : h) + (i + 1 == n ? 10 / h : 0);
                u[i] = x;
                constraints.emplace_back(i, i, 1.0);
                if (both) {
                    constraints.emplace_back(n + i, i, -1.0);
                    o.c[n + i] = -10;
                }
            }
            SparseMatrix A(n, n), M(n, n), B(rows, n);
            A.setFromTriplets(stiffness.begin(), stiffness.end());
            M.setFromTriplets(mass.begin(), mass.end());
            B.setFromTriplets(constraints.begin(), constraints.end());
            o.A = Matrix(A);
            o.B = Matrix(B);
            const auto prepared = KluActiveSet().prepare(o.A, o.B);
            for (int step = 0; step < 6; ++step) {
                o.b = M * u + load;
                const auto report = prepared->solve(o.b, o.c, {u, lambda});
                ASSERT_EQ(report.outcome, Outcome::converged);
                EXPECT_LE(report.iterations, 8);
                expect_solution(o, u, lambda, 1e-11);
            }
        }
}

/// Every set of rows, each solved by a dense LU: the one whose answer violates nothing.
Vector by_enumeration(const DenseMatrix& S, const Vector& g) {
    const Index m = g.size();
    for (int set = 0; set < 1 << m; ++set) {
        std::vector<Index> on;
        for (Index i = 0; i < m; ++i)
            if (set >> i & 1) on.push_back(i);
        Vector lambda = Vector::Zero(m);
        if (!on.empty()) lambda(on) = DenseMatrix(S(on, on)).fullPivLu().solve(Vector(g(on)));
        const Vector w = S * lambda - g;
        if (lambda.minCoeff() >= 0 && w.minCoeff() >= -1e-12 * (g.norm() + S.norm() * lambda.norm())) return lambda;
    }
    ADD_FAILURE() << "no set";
    return Vector::Zero(m);
}

/// x'Sx > 0, and far from symmetric: sets come back in a fifth of these.
DenseMatrix skew(std::mt19937& random, Index m, double turn) {
    std::normal_distribution<double> normal;
    const DenseMatrix G = DenseMatrix::NullaryExpr(m, m, [&] { return normal(random); });
    const DenseMatrix H = DenseMatrix::NullaryExpr(m, m, [&] { return normal(random); });
    return 0.1 * G * G.transpose() + 0.05 * DenseMatrix::Identity(m, m) + turn * (H - H.transpose());
}

TEST(KluActiveSet, AgreesWithEnumerationWhereSetsComeBack) {
    std::mt19937 random(11);
    std::normal_distribution<double> normal;
    int repeated = 0;
    for (int k = 0; k < 300; ++k) {
        const Index n = 3 + k % 6;
        const DenseMatrix A = skew(random, n, 2);
        const DenseMatrix B =
            DenseMatrix::Identity(n, n) + 0.2 * DenseMatrix::NullaryExpr(n, n, [&] { return normal(random); });
        const Vector b = Vector::NullaryExpr(n, [&] { return normal(random); });
        const Vector c = Vector::NullaryExpr(n, [&] { return normal(random); });
        const DenseMatrix inverse = A.fullPivLu().inverse();
        for (const bool bounds : {true, false}) {
            const DenseMatrix rows = bounds ? DenseMatrix(DenseMatrix::Identity(n, n)) : B;
            const Vector expected = by_enumeration(rows * inverse * rows.transpose(), c - rows * inverse * b);
            Vector u = Vector::Zero(n), lambda = u;
            const auto report = KluActiveSet().prepare(Matrix(A), Matrix(rows))->solve(b, c, {u, lambda});
            ASSERT_EQ(report.outcome, Outcome::converged) << k;
            EXPECT_LE((lambda - expected).norm(), 1e-7 * (1 + expected.norm())) << k;
            repeated += report.set_repeated;
        }
    }
    EXPECT_GT(repeated, 5);
}

TEST(UnsymmetricActiveSet, AgreesWithLemke) {
    std::mt19937 random(3);
    std::normal_distribution<double> normal;
    for (int k = 0; k < 100; ++k) {
        const Index m = 5 + k % 40;
        const DenseMatrix S = skew(random, m, 0.3);
        const Vector g = Vector::NullaryExpr(m, [&] { return normal(random); });
        const LemkeReport lemke_end = lemke(S, g);
        ASSERT_EQ(lemke_end.outcome, Outcome::converged);
        Vector lambda = Vector::Zero(m), w(m);
        UnsymmetricActiveSet active_set;
        ASSERT_EQ(active_set.solve(S, g, Vector::Constant(m, 1e-13), lambda, w).outcome, Outcome::converged);
        for (Index i = 0; i < m; ++i) EXPECT_EQ(lambda[i] > 0, lemke_end.basic[static_cast<std::size_t>(i)] != 0);
    }
}

/// Projected Gauss-Seidel to rounding, which converges where the diagonal dominates.
Vector by_relaxation(const DenseMatrix& A, const Vector& b, const Vector& lower, const Vector& upper) {
    Vector u = lower.cwiseMax(0).cwiseMin(upper);
    for (int sweep = 0; sweep < 400; ++sweep)
        for (Index i = 0; i < u.size(); ++i)
            u[i] = std::min(std::max(u[i] + (b[i] - A.row(i).dot(u)) / A(i, i), lower[i]), upper[i]);
    return u;
}

TEST(KluActiveSet, AgreesWithProjectedGaussSeidelBetweenBoundsOfBothSigns) {
    std::mt19937 random(17);
    std::normal_distribution<double> normal;
    for (int k = 0; k < 20; ++k) {
        const Index n = 90;
        DenseMatrix A =
            DenseMatrix::NullaryExpr(n, n, [&] { return std::abs(normal(random)) > 1.5 ? normal(random) : 0.0; });
        A.diagonal() =
            1.2 * A.cwiseAbs().rowwise().sum().cwiseMax(A.cwiseAbs().colwise().sum().transpose()) + Vector::Ones(n);
        const Vector b = Vector::NullaryExpr(n, [&] { return 20 * normal(random); });
        const Vector lower = Vector::NullaryExpr(n, [&] { return -std::abs(normal(random)); });
        const Vector upper = Vector::NullaryExpr(n, [&] { return std::abs(normal(random)); });
        DenseMatrix B(2 * n, n);
        B << 3 * DenseMatrix::Identity(n, n), -0.5 * DenseMatrix::Identity(n, n);
        Vector c(2 * n);
        c << 3 * lower, -0.5 * upper;
        Vector u = Vector::Zero(n), lambda = Vector::Zero(2 * n);
        const auto report = KluActiveSet()
                                .prepare(Matrix(SparseMatrix(A.sparseView())), Matrix(SparseMatrix(B.sparseView())))
                                ->solve(b, c, {u, lambda});
        ASSERT_EQ(report.outcome, Outcome::converged);
        EXPECT_LE((u - by_relaxation(A, b, lower, upper)).lpNorm<Eigen::Infinity>(), 1e-12);
    }
}

TEST(KluActiveSet, AnswersTheSameFromThePoolAndRefactored) {
    // Small loads touch few rows, and large ones most of them; what was prepared once has a pool by then.
    for (const double wind : {0.0, 20.0}) {
        Obstacle o = square(24, wind, 0);
        const Vector full = o.b;
        const auto prepared = KluActiveSet().prepare(o.A, o.B);
        Vector u = Vector::Zero(full.size()), lambda = u;
        bool pool = false, refactored = false;
        for (int step = 0; step < 40; ++step) {
            o.b = full * (step % 10 == 9 ? 1.0 : (wind > 0 ? 0.004 : 0.03) * (1 + step % 7));
            const auto report = prepared->solve(o.b, o.c, {u, lambda});
            ASSERT_EQ(report.outcome, Outcome::converged);
            expect_solution(o, u, lambda, 1e-12);
            pool |= report.strategy == "KLU pool" && report.active > 0;
            refactored |= report.strategy == "KLU condensed";
        }
        EXPECT_TRUE(pool);
        EXPECT_TRUE(refactored);
    }
}

}  // namespace
}  // namespace tact
