// Problems with rows of every kind, marched and solved: against the same problem written with contact rows only.
#include <gtest/gtest.h>

#include "../../contact/automatic.hpp"
#include "../../integrators/moreau_jean.hpp"
#include "../../integrators/sundials/bdf2.hpp"
#include "../../integrators/trapezoid.hpp"
#include "../../rom/model/reduce.hpp"

namespace tact {
namespace {

/// A rod that is heated on one side and cooled on the other, with 0 <= u <= 1 everywhere; D u' + K u = f.
ContactProblem rod(Index n) {
    SparseMatrix K(n, n), D(n, n);
    const double h = 1.0 / static_cast<double>(n + 1);
    for (Index i = 0; i < n; ++i) {
        K.insert(i, i) = 2 / h;
        D.insert(i, i) = h;
        if (i > 0) K.insert(i, i - 1) = -1 / h;
        if (i + 1 < n) K.insert(i, i + 1) = -1 / h;
    }
    ContactProblem p;
    p.K = Matrix(std::move(K));
    p.D = Matrix(std::move(D));
    p.B = Matrix::identity(n);
    p.c = AffineVector(Vector(Vector::Zero(n)));
    Vector f = Vector::Constant(n, 40 * h);
    f.head(n / 2) *= -1;
    p.f = AffineVector(f);
    p.u0 = Vector::LinSpaced(n, 0, 1);
    return p;
}

/// B u <= c_up as rows -B u >= -c_up.
ContactProblem as_contact_rows(ContactProblem p) {
    const Vector lower = p.c.at(0), upper = p.c_up->at(0);
    const DenseMatrix B = p.B.to_dense();
    DenseMatrix both(2 * B.rows(), B.cols());
    both << B, -B;
    Vector c(2 * lower.size());
    c << lower, -upper;
    p.B = Matrix(Matrix(both).to_sparse());
    p.c = AffineVector(c);
    p.c_up.reset();
    return p;
}

MarchReport march(const Integrator& method, const ContactProblem& problem, double dt, long steps) {
    ContactWorkspace workspace(std::make_shared<AutomaticContact>());
    return integrate(method, problem, {dt, steps}, workspace);
}

TEST(IntervalRows, BoundsOnBothSidesMarchAsTwoContactRows) {
    for (const Index n : {20, 400}) {
        ContactProblem two = rod(n);
        two.c_up = AffineVector(Vector(Vector::Ones(n)));
        const MarchReport a = march(Bdf2(), two, 0.02, 10), b = march(Bdf2(), as_contact_rows(two), 0.02, 10);
        ASSERT_EQ(a.outcome, Outcome::converged);
        ASSERT_EQ(b.outcome, Outcome::converged);
        EXPECT_LE((a.final_state.u() - b.final_state.u()).lpNorm<Eigen::Infinity>(), 1e-9);
        const Vector split = b.final_state.lambda.head(n) - b.final_state.lambda.tail(n);
        EXPECT_LE((a.final_state.lambda - split).lpNorm<Eigen::Infinity>(), 1e-7);
        EXPECT_GT(a.final_state.lambda.maxCoeff(), 0);
        EXPECT_LT(a.final_state.lambda.minCoeff(), 0);
        EXPECT_LE(a.worst_kkt.largest(), 1e-9);
    }
}

/// Two masses tied to each other move as one of their sum: x'' = -x by hand.
TEST(IntervalRows, AnEquationTiesTwoMasses) {
    ContactProblem p;
    p.M = Matrix::diagonal(Vector{{1, 3}});
    p.K = Matrix(DenseMatrix{{4, 0}, {0, 0}});
    p.B = Matrix(DenseMatrix{{1, -1}});
    p.c = AffineVector(Vector(Vector::Zero(1)));
    p.c_up = p.c;
    p.f = AffineVector(Vector(Vector::Zero(2)));
    p.u0 = Vector::Ones(2);
    p.v0 = Vector::Zero(2);
    const MarchReport report = march(Bdf2(), p, 1e-3, 1000);
    ASSERT_EQ(report.outcome, Outcome::converged);
    EXPECT_NEAR(report.final_state.u()[0], std::cos(1.0), 1e-5);
    EXPECT_NEAR(report.final_state.u()[0], report.final_state.u()[1], 1e-12);
    EXPECT_NEAR(report.final_state.lambda[0], 3 * std::cos(1.0), 1e-3);  // M_1 a_1 + K_1 u_1 = -1 cos + 4 cos
}

TEST(IntervalRows, AStartAboveAnUpperBoundIsRefusedOrProjected) {
    ContactProblem p = rod(10);
    p.c_up = AffineVector(Vector(Vector::Constant(10, 0.5)));
    EXPECT_THROW((void)march(Bdf2(), p, 0.01, 1), InputError);
    ContactWorkspace workspace(std::make_shared<AutomaticContact>());
    const MarchReport report =
        integrate(Bdf2(), p, {0.01, 0}, workspace, {}, {.initial_penetration = InitialPenetration::project});
    EXPECT_LE(report.final_state.u().maxCoeff(), 0.5 + 1e-12);
}

TEST(IntervalRows, WhatTakesContactRowsOnlySaysSo) {
    ContactProblem p = rod(10);
    p.M = p.D;
    p.v0 = Vector::Zero(10);
    p.c_up = AffineVector(Vector(Vector::Ones(10)));
    EXPECT_THROW((void)march(Trapezoid(), p, 0.01, 1), InputError);
    EXPECT_THROW((void)march(MoreauJean(), p, 0.01, 1), InputError);
    EXPECT_THROW((void)reduce(p, ReducedBasis{DenseMatrix::Identity(10, 2), DenseMatrix::Identity(10, 2)}),
                 InputError);
}

TEST(IntervalRows, BadBoundsAreNamed) {
    const auto refused = [](auto change) {
        ContactProblem p = rod(4);
        p.c_up = AffineVector(Vector(Vector::Ones(4)));
        change(p);
        EXPECT_THROW(validate(p), InputError);
    };
    refused([](ContactProblem& p) { p.c_up = AffineVector(Vector(Vector::Constant(4, -1))); });
    refused([](ContactProblem& p) { p.c_up = AffineVector(Vector(Vector::Ones(3))); });
    refused([](ContactProblem& p) { p.c_up = AffineVector(Vector(Vector::Constant(4, std::nan("")))); });
    refused([](ContactProblem& p) { p.force_up = Vector::Constant(4, -1); });
    refused([](ContactProblem& p) { p.force_lo = Vector::Constant(4, 1); });
    refused([](ContactProblem& p) { p.force_lo = Vector::Zero(2); });
    refused([](ContactProblem& p) { p.force_up = Vector::Constant(4, std::nan("")); });
}

}  // namespace
}  // namespace tact
