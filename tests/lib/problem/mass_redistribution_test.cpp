#include "../../../lib/problem/mass_redistribution.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "../../../lib/errors.hpp"

namespace tact {
namespace {

/// n masses 1, 2, 3, ... in a line between springs 1, the rows of B at the given ones; free at both ends.
ContactProblem chain(Index n, const std::vector<Index>& contact) {
    ContactProblem p;
    std::vector<Eigen::Triplet<double, long>> springs, rows;
    for (Index i = 0; i + 1 < n; ++i)
        for (const auto& [r, c, k] : {std::tuple{i, i, 1.0}, {i + 1, i + 1, 1.0}, {i, i + 1, -1.0}, {i + 1, i, -1.0}})
            springs.emplace_back(r, c, k);
    for (const Index i : contact) rows.emplace_back(long(rows.size()), i, -2.5);
    SparseMatrix K(n, n), B(Index(contact.size()), n);
    K.setFromTriplets(springs.begin(), springs.end());
    B.setFromTriplets(rows.begin(), rows.end());
    p.M = Matrix::diagonal(Vector::LinSpaced(n, 1, double(n)));
    p.K = Matrix(K);
    p.B = Matrix(B);
    p.c = Vector(Vector::Zero(B.rows()));
    p.f = Vector(Vector::Zero(n));
    p.u0 = p.v0 = Vector::Zero(n);
    return p;
}

TEST(MassRedistribution, EndsGiveToTheirNeighbours) {
    const ContactProblem before = chain(6, {0, 5}), after = redistribute_mass(before, 0);
    EXPECT_EQ(*after.M->diagonal_entries(), (Vector(6) << 0, 3, 3, 4, 11, 0).finished());
    EXPECT_TRUE(after.K.same_storage(before.K));
    EXPECT_EQ((*before.M->diagonal_entries())[0], 1) << "the given problem is left alone";
}

TEST(MassRedistribution, InnerUnknownsKeepTheCentreOfMass) {
    const Vector x = Vector::LinSpaced(7, 0, 6);
    const Vector before = chain(7, {}).M->main_diagonal(),
                 after = redistribute_mass(chain(7, {2, 4})).M->main_diagonal();
    EXPECT_NEAR(after.sum(), 28, 1e-13);
    EXPECT_NEAR(x.dot(after), x.dot(before), 1e-13);
    EXPECT_NEAR(after[2] / (3 * 1e-14), 1, 1e-12) << "what keeps M invertible, without cancellation";
    EXPECT_NEAR(after[3], 4 + 1.5 + 2.5, 1e-12);
}

TEST(MassRedistribution, AWholePatchPassesItsMassOn) {
    const Vector after = redistribute_mass(chain(8, {0, 1, 2, 5, 6}), 0.1).M->main_diagonal();
    EXPECT_NEAR(after.sum(), 36, 1e-13);
    EXPECT_DOUBLE_EQ(after[0], 0.1);
    EXPECT_DOUBLE_EQ(after[1], 0.2);
    EXPECT_DOUBLE_EQ(after[3], 4 + 0.9 * 6);
    EXPECT_DOUBLE_EQ(after[4], 5 + 0.9 * 6);
    EXPECT_DOUBLE_EQ(after[7], 8 + 0.9 * 7);
}

TEST(MassRedistribution, SharesFollowTheCoupling) {
    // Unknown 0 in contact: pulled by -3 and -1 on 1 and 2; +4 on 3 takes no part. Where all repel, their size counts.
    ContactProblem p = chain(4, {0});
    DenseMatrix K(4, 4);
    K << 8, -3, -1, 4, -3, 8, 0, 0, -1, 0, 8, 0, 4, 0, 0, 8;
    p.K = Matrix(K);
    EXPECT_EQ(redistribute_mass(p, 0).M->main_diagonal(), Eigen::Vector4d(0, 2.75, 3.25, 4));
    K << 8, 3, 1, 4, 3, 8, 0, 0, 1, 0, 8, 0, 4, 0, 0, 8;
    p.K = Matrix(K);
    EXPECT_EQ(redistribute_mass(p, 0).M->main_diagonal(), Eigen::Vector4d(0, 2.375, 3.125, 4.5));
}

TEST(MassRedistribution, AOneSidedCouplingLosesNoMass) {
    ContactProblem p = chain(3, {0});
    DenseMatrix K = DenseMatrix::Identity(3, 3);
    K(0, 2) = -1;  // row 0 feels unknown 2, which does not feel it
    p.K = Matrix(K);
    EXPECT_EQ(redistribute_mass(p, 0).M->main_diagonal(), Eigen::Vector3d(0, 2, 4));
    p.K = Matrix(DenseMatrix(K.transpose()));
    EXPECT_EQ(redistribute_mass(p, 0).M->main_diagonal(), Eigen::Vector3d(0, 2, 4));
}

TEST(MassRedistribution, NothingToDoIsFine) {
    EXPECT_EQ(redistribute_mass(chain(4, {})).M->main_diagonal(), Eigen::Vector4d(1, 2, 3, 4));
    EXPECT_EQ(redistribute_mass(chain(4, {1}), 1).M->main_diagonal(), Eigen::Vector4d(1, 2, 3, 4));
}

TEST(MassRedistribution, ContactUnknownsStartInEquilibriumAsFarAsTheirRowsAllow) {
    // Rows -2.5 u_i >= 0: the ends must not be above zero. Spring forces on unknown i: the sum of u_j - u_i, and its load.
    ContactProblem p = chain(6, {0, 5});
    p.u0 << -3, -1, -1, 2, 1, -0.5;
    p.v0 << 7, 1, 0, 0, -2, 7;
    p.f = Vector(Vector::Constant(6, -0.25));
    const ContactProblem after = redistribute_mass(p);
    EXPECT_NEAR(after.u0[0], -1.25, 1e-14);
    EXPECT_EQ(after.u0[5], 0) << "its equilibrium, .75, is beyond the stop";
    EXPECT_NEAR(after.v0[0], 1, 1e-14);
    EXPECT_EQ(after.v0[5], 7) << "held";
    EXPECT_EQ(after.u0.segment(1, 4), p.u0.segment(1, 4));
    EXPECT_EQ(redistribute_mass(p, 0.5).u0, p.u0) << "has inertia of its own";
}

TEST(MassRedistribution, APatchSettlesAsAWholeAndARowOfSeveralEntriesStaysWhereItWas) {
    ContactProblem p = chain(6, {0, 1});
    p.u0 << -5, -4, -1, 0, 0, 0;
    EXPECT_LE((redistribute_mass(p).u0.head(2) - Eigen::Vector2d(-1, -1)).norm(), 1e-13);
    SparseMatrix B(1, 6);
    B.insert(0, 0) = 1;
    B.insert(0, 1) = -1;
    p.B = Matrix(B);
    p.c = Vector(Vector::Constant(1, -1.0));
    EXPECT_LE((redistribute_mass(p).u0.head(2) - Eigen::Vector2d(-1, -1)).norm(), 1e-13);
    p.f = Vector((Vector(6) << -4, 1, 0, 0, 0, 0).finished());
    EXPECT_EQ(redistribute_mass(p).u0, p.u0);
}

TEST(MassRedistribution, RejectsWhatIsImpossible) {
    EXPECT_THROW(redistribute_mass(chain(3, {0, 1, 2})), InputError);
    EXPECT_THROW(redistribute_mass(chain(3, {0}), -0.1), InputError);
    EXPECT_THROW(redistribute_mass(chain(3, {0}), std::nan("")), InputError);
    ContactProblem p = chain(3, {0});
    p.M = Matrix(DenseMatrix(DenseMatrix::Identity(3, 3)));
    EXPECT_THROW(redistribute_mass(p), InputError);
    p.M.reset();
    EXPECT_THROW(redistribute_mass(p), InputError);
    p.M = Matrix::identity(2);
    EXPECT_THROW(redistribute_mass(p), InputError);
    p = chain(3, {0});
    p.K = Matrix::identity(3);
    EXPECT_THROW(redistribute_mass(p), InputError) << "no neighbours";
}

}  // namespace
}  // namespace tact
