// Bodies that nothing but contact holds, against statics: what balances a load is known without any solver.
#include "../../../contact/strategies/floating_contact.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <Eigen/Eigenvalues>
#include <cmath>
#include <random>

#include "../../../contact/automatic.hpp"
#include "../../elastic_blocks.hpp"
#include "../../laws/judge.hpp"

namespace tact {
namespace {

struct Answer {
    ContactReport report;
    Vector u, lambda;
};

Answer solve(const ContactSolver& solver, const Matrix& A, const Matrix& B, const Vector& b, const Vector& c) {
    Answer a{{}, Vector::Zero(A.rows()), Vector::Zero(B.rows())};
    a.report = solver.prepare(A, B)->solve(b, c, {a.u, a.lambda});
    return a;
}

SparseMatrix row_of(Index n, Index column, double weight = 1) {
    SparseMatrix B(1, n);
    B.insert(0, column) = weight;
    B.makeCompressed();
    return B;
}

/// Springs of the given stiffness between neighbours, none to the ground.
SparseMatrix chain(const Vector& stiffness) {
    const Index n = stiffness.size() + 1;
    std::vector<Eigen::Triplet<double, long>> entries;
    for (Index i = 0; i + 1 < n; ++i) {
        entries.emplace_back(i, i, stiffness[i]);
        entries.emplace_back(i + 1, i + 1, stiffness[i]);
        entries.emplace_back(i, i + 1, -stiffness[i]);
        entries.emplace_back(i + 1, i, -stiffness[i]);
    }
    SparseMatrix K(n, n);
    K.setFromTriplets(entries.begin(), entries.end());
    return K;
}

/// A pressure around the middle of the top, downwards.
Vector pressed(const test::ElasticBlock& block, int dimension) {
    Vector f = Vector::Zero(block.size());
    for (const Index i : block.top()) {
        const auto X = block.place(i);
        double r2 = 0;
        for (int d = 0; d + 1 < dimension; ++d) r2 += std::pow(X[static_cast<std::size_t>(d)] - 0.5, 2);
        f[block.unknown(i, dimension - 1)] = -0.02 * std::exp(-r2 / 0.02);
    }
    return f;
}

TEST(FloatingContact, ABarOnOneStopCarriesItsLoadWhateverItsLength) {
    for (const Index cells : {1, 2, 100, 1000, 8000, 20000, 100000})
        for (const double scale : {1e-4, 1.0, 1e4}) {
            const SparseMatrix K = chain(Vector::Constant(cells, static_cast<double>(cells) * scale));
            Vector f = Vector::Zero(cells + 1);
            f[cells] = -1;
            for (const std::shared_ptr<const ContactSolver>& solver :
                 {std::shared_ptr<const ContactSolver>(std::make_shared<FloatingContact>()),
                  std::shared_ptr<const ContactSolver>(std::make_shared<AutomaticContact>())}) {
                const Answer a = solve(*solver, Matrix(K), Matrix(row_of(cells + 1, 0)), f, Vector::Zero(1));
                ASSERT_EQ(a.report.outcome, Outcome::converged) << cells;
                EXPECT_NEAR(a.lambda[0], 1, 1e-10) << cells;
                EXPECT_NEAR(a.u[cells] * scale, -1, 1e-10) << cells;
            }
        }
}

TEST(FloatingContact, ABarOnASoftSpringSharesItsLoadAsStaticsSays) {
    // The stop at one end at 0, a spring s at the other, a load of 1 there: u_end = -1 / (1 + s), lambda = 1 / (1 + s).
    for (const Index cells : {50, 2000, 20000})
        for (const double spring : {1e-3, 1e-6, 1e-9}) {
            SparseMatrix K = chain(Vector::Constant(cells, static_cast<double>(cells)));
            K.coeffRef(cells, cells) += spring;
            Vector f = Vector::Zero(cells + 1);
            f[cells] = -1;
            const Answer a = solve(AutomaticContact(), Matrix(K), Matrix(row_of(cells + 1, 0)), f, Vector::Zero(1));
            ASSERT_EQ(a.report.outcome, Outcome::converged) << cells << " " << spring;
            EXPECT_NEAR(a.lambda[0], 1 / (1 + spring), 1e-10) << cells << " " << spring;
        }
}

TEST(FloatingContact, ABlockOnAPlaneIsHeldByItsWholeLoadWithAndWithoutSoftSprings) {
    for (const int dimension : {2, 3})
        for (const double springs : {0.0, 1e-9, 1e-6})
            for (const double scale : {1.0, 1e4}) {
                const test::ElasticBlock block(dimension, {8, dimension == 2 ? 4 : 8, 4}, 1.0 / 8);
                // Displacements in units that differ from unknown to unknown.
                Vector unit = Vector::Ones(block.size());
                for (Index i = 0; i < unit.size(); ++i) unit[i] = i % 3 == 0 ? scale : i % 3 == 1 ? 1 / scale : 1;
                SparseMatrix A = block.K();
                if (springs > 0) A += springs * block.M();
                A = unit.asDiagonal() * A * unit.asDiagonal();
                const SparseMatrix B = block.bottom_rows() * unit.asDiagonal();
                const Vector f = pressed(block, dimension);
                const Answer a =
                    solve(AutomaticContact(), Matrix(A), Matrix(B), unit.cwiseProduct(f), Vector::Zero(B.rows()));
                ASSERT_EQ(a.report.outcome, Outcome::converged) << dimension << " " << springs;
                Vector up = Vector::Zero(block.size());
                for (Index i = 0; i < block.nodes(); ++i) up[block.unknown(i, dimension - 1)] = 1;
                const double load = -up.dot(f);
                const double carried = springs * up.dot(block.M() * unit.cwiseProduct(a.u));
                EXPECT_NEAR((a.lambda.sum() - carried) / load, 1, springs > 0 ? 1e-9 : 1e-12);
                EXPECT_GT(a.report.active, 0);
                EXPECT_LT(a.report.kkt.largest(), 1e-12);
            }
}

TEST(FloatingContact, TwoFreeBlocksOneOnTheOtherPassTheLoadOn) {
    const test::ElasticBlock block(3, {4, 4, 2}, 0.25);
    const Index n = block.size();
    std::vector<Eigen::Triplet<double, long>> k, rows;
    for (int body = 0; body < 2; ++body)
        for (Index j = 0; j < n; ++j)
            for (SparseMatrix::InnerIterator it(block.K(), j); it; ++it)
                k.emplace_back(body * n + it.row(), body * n + j, (1 + body) * it.value());
    const auto bottom = block.bottom(), top = block.top();
    const auto m = static_cast<Index>(bottom.size());
    for (Index i = 0; i < m; ++i) {  // the lower body on the plane, the upper one on the lower
        rows.emplace_back(i, block.unknown(bottom[static_cast<std::size_t>(i)], 2), 1.0);
        rows.emplace_back(m + i, n + block.unknown(bottom[static_cast<std::size_t>(i)], 2), 1.0);
        rows.emplace_back(m + i, block.unknown(top[static_cast<std::size_t>(i)], 2), -1.0);
    }
    SparseMatrix A(2 * n, 2 * n), B(2 * m, 2 * n);
    A.setFromTriplets(k.begin(), k.end());
    B.setFromTriplets(rows.begin(), rows.end());
    Vector f = Vector::Zero(2 * n);
    f.tail(n) = pressed(block, 3);
    const Answer a = solve(AutomaticContact(), Matrix(A), Matrix(B), f, Vector::Zero(2 * m));
    ASSERT_EQ(a.report.outcome, Outcome::converged);
    EXPECT_NEAR(a.lambda.head(m).sum() / -f.sum(), 1, 1e-12);
    EXPECT_NEAR(a.lambda.tail(m).sum() / -f.sum(), 1, 1e-12);
}

TEST(FloatingContact, WithoutRowsABalancedLoadIsSolvedAndAnotherHasARay) {
    const SparseMatrix K = chain(Vector::Ones(2));
    const Matrix none = Matrix::without_rows(3);
    const Vector balanced = (Vector(3) << 1, 0, -1).finished();
    const Answer a = solve(AutomaticContact(), Matrix(K), none, balanced, Vector(0));
    ASSERT_EQ(a.report.outcome, Outcome::converged);
    EXPECT_NEAR(0.5 * a.u.dot(K * a.u) - balanced.dot(a.u), -1, 1e-12);
    const Answer b = solve(AutomaticContact(), Matrix(K), none, Vector::Ones(3), Vector(0));
    ASSERT_EQ(b.report.outcome, Outcome::unbounded);
    EXPECT_LT((K * b.report.ray).norm(), 1e-12);
    EXPECT_GT(b.report.ray.sum(), 0);
}

TEST(FloatingContact, AMechanismThatRowsHoldInPartIsSolvedOrHasARay) {
    // Two chains side by side, a stop under the first only.
    SparseMatrix K(6, 6);
    const SparseMatrix one = chain(Vector::Ones(2));
    std::vector<Eigen::Triplet<double, long>> entries;
    for (Index j = 0; j < 3; ++j)
        for (SparseMatrix::InnerIterator it(one, j); it; ++it)
            for (Index body = 0; body < 2; ++body)
                entries.emplace_back(3 * body + it.row(), 3 * body + j, it.value());
    K.setFromTriplets(entries.begin(), entries.end());
    Vector f(6);
    f << 0, 0, -1, 1, 0, -1;
    const Answer a = solve(AutomaticContact(), Matrix(K), Matrix(row_of(6, 0)), f, Vector::Zero(1));
    ASSERT_EQ(a.report.outcome, Outcome::converged);
    EXPECT_NEAR(a.lambda[0], 1, 1e-13);
    EXPECT_NEAR(a.u[3] - a.u[5], 2, 1e-13);
    f[5] = -2;
    EXPECT_EQ(solve(AutomaticContact(), Matrix(K), Matrix(row_of(6, 0)), f, Vector::Zero(1)).report.outcome,
              Outcome::unbounded);
}

/// min 1/2 u'Au - b'u with many modes without stiffness, feasible and with a solution by construction: (x, lambda) satisfies
/// all conditions, so that the least value is known.
struct Known {
    laws::QuadraticProgram qp;
    double least;
};

Known semidefinite(std::mt19937& random, bool turned, bool forces) {
    const auto from = [&](int least, int most) {
        return least + static_cast<int>(random() % static_cast<unsigned>(most - least + 1));
    };
    const Index n = from(2, 14), m = from(1, 20);
    Vector stiffness(n);
    for (double& k : stiffness) k = from(0, 2) == 0 ? 10 : 0;
    Vector x = 3 * laws::random_vector(random, n);
    DenseMatrix Q = DenseMatrix::Identity(n, n);
    if (turned) Q = laws::random_matrix(random, n, n).householderQr().householderQ();
    Known known{{Q * stiffness.asDiagonal() * Q.transpose(), laws::random_matrix(random, m, n), {}, {}}, 0};
    laws::QuadraticProgram& qp = known.qp;
    qp.A = (0.5 * (qp.A + qp.A.transpose())).eval();
    for (double& entry : qp.B.reshaped())
        if (from(0, 2) != 0) entry = 0;
    if (!forces) {
        x = Q * (stiffness.array() == 0).select(x, 0.0).matrix();
        qp.c = qp.B * x;
        for (double& c : qp.c) c -= from(0, 1) * std::abs(laws::random_vector(random, 1)[0]);
        qp.b = Vector::Zero(n);
    } else {
        qp.c = qp.B * x;
        Vector lambda = Vector::Zero(m);
        for (Index i = 0; i < m; ++i) {
            const double size = std::abs(laws::random_vector(random, 1)[0]);
            if (from(0, 1) == 0)
                lambda[i] = size;
            else if (from(0, 1) == 0)
                qp.c[i] -= size;
        }
        qp.b = qp.A * x - qp.B.transpose() * lambda;
    }
    known.least = forces ? 0.5 * x.dot(qp.A * x) - qp.b.dot(x) : 0;
    return known;
}

TEST(FloatingContact, ProgrammesWithManyFreeModesReachTheLeastValueKnownByConstruction) {
    for (const bool turned : {false, true})
        for (const bool forces : {false, true}) {
            std::mt19937 random(11);
            for (int draw = 0; draw < 240; ++draw) {
                const Known known = semidefinite(random, turned, forces);
                const laws::QuadraticProgram& qp = known.qp;
                const Answer a = solve(AutomaticContact(), Matrix(qp.A), Matrix(qp.B), qp.b, qp.c);
                ASSERT_EQ(a.report.outcome, Outcome::converged) << turned << forces << " " << draw;
                const double value = 0.5 * a.u.dot(qp.A * a.u) - qp.b.dot(a.u);
                EXPECT_NEAR(value, known.least, 1e-9 * (1 + std::abs(known.least)))
                    << turned << forces << " " << draw;
                EXPECT_LE((qp.c - qp.B * a.u).maxCoeff(), 1e-9 * (1 + a.u.norm()));
                EXPECT_GE(a.lambda.minCoeff(), 0);
            }
        }
}

TEST(FloatingContact, WhatNoPointSatisfiesIsInfeasibleNotUnbounded) {
    // u_0 >= 1, -u_0 >= 0, and a load along u_1, which nothing holds.
    DenseMatrix B(2, 2);
    B << 1, 0, -1, 0;
    const Vector b = (Vector(2) << 0, 1).finished(), c = (Vector(2) << 1, 0).finished();
    const Answer a = solve(FloatingContact(), Matrix(DenseMatrix(DenseMatrix::Zero(2, 2))), Matrix(B), b, c);
    ASSERT_EQ(a.report.outcome, Outcome::infeasible);
    EXPECT_EQ(laws::fault_of_certificate({DenseMatrix::Zero(2, 2), B, b, c}, a.report.infeasibility), "");
}

TEST(FloatingContact, IndefiniteMatricesAreRefused) {
    DenseMatrix A(2, 2);
    A << 1, 2, 2, 1;
    EXPECT_THROW((void)FloatingContact().prepare(Matrix(A), Matrix::without_rows(2)), NumericalError);
    A << 0, 1, 1, 0;
    EXPECT_THROW((void)FloatingContact().prepare(Matrix(A), Matrix::without_rows(2)), NumericalError);
    EXPECT_THROW((void)FloatingContact().prepare(Matrix(SparseMatrix(A.sparseView())), Matrix::without_rows(2)),
                 NumericalError);
}

}  // namespace
}  // namespace tact
