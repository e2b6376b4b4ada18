#include "../../../rom/model/reduce.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "../../../contact/dense/dense_contact.hpp"
#include "../../../integrators/sundials/bdf2.hpp"
#include "../../../lib/errors.hpp"
#include "../../../lib/time/trajectory.hpp"
#include "../chain.hpp"

namespace tact {
namespace {

using testing::chain;
using testing::ChainFamily;
using testing::identity;
using testing::scattered;

constexpr Index n = 24, m = 12, p = 6, p_lambda = 4;

ReducedBasis some_basis() { return {scattered(n, p), scattered(m, p_lambda).cwiseAbs()}; }

double difference(const Matrix& A, const DenseMatrix& B) { return (A.to_dense() - B).cwiseAbs().maxCoeff(); }

TEST(Reduce, IsThePairOfProjectionsOfEveryTerm) {
    const ContactProblem full = chain(n, -0.4, {.damping = true});
    const ReducedBasis basis = some_basis();
    const DenseMatrix &U = basis.U, &W = basis.U_lambda;
    const ContactProblem reduced = reduce(full, basis);
    EXPECT_NO_THROW(validate(reduced));
    EXPECT_LT(difference(*reduced.M, U.transpose() * full.M->to_dense() * U), 1e-13);
    EXPECT_LT(difference(*reduced.D, U.transpose() * full.D->to_dense() * U), 1e-13);
    EXPECT_LT(difference(reduced.K, U.transpose() * full.K.to_dense() * U), 1e-13);
    EXPECT_LT(difference(reduced.B, W.transpose() * full.B.to_dense() * U), 1e-13);
    EXPECT_LT((reduced.c.at(0) - W.transpose() * full.c.at(0)).norm(), 1e-14);
    for (const double t : {0.0, 0.3, 2.0}) EXPECT_LT((reduced.f.at(t) - U.transpose() * full.f.at(t)).norm(), 1e-14);
    EXPECT_EQ(reduced.f.jumps, full.f.jumps);
    EXPECT_TRUE(reduced.K.dense());
    EXPECT_EQ(reduced.K.to_dense(), reduced.K.to_dense().transpose());
}

TEST(Reduce, StoresDiagonalMatricesInModalCoordinates) {
    ContactProblem full = chain(n);
    full.D = combine(0.1, *full.M, 0.02, full.K);  // Rayleigh: diagonal in the same coordinates
    const ContactProblem reduced = reduce(full, modal_basis(full, some_basis()));
    ASSERT_TRUE(reduced.M->diagonal_entries());
    EXPECT_EQ(*reduced.M->diagonal_entries(), Vector::Ones(p));
    EXPECT_TRUE(reduced.K.diagonal_entries());
    EXPECT_TRUE(reduced.D->diagonal_entries());
}

TEST(Reduce, WithUnitBasesKeepsTheProblem) {
    const ContactProblem full = chain(n, -0.4, {.damping = true});
    const ContactProblem same = reduce(full, {identity(n), identity(m)});
    EXPECT_EQ(difference(*same.M, full.M->to_dense()), 0);
    EXPECT_EQ(difference(same.K, full.K.to_dense()), 0);
    EXPECT_EQ(difference(same.B, full.B.to_dense()), 0);
    EXPECT_EQ(same.c.modes, full.c.modes);
    EXPECT_EQ(same.f.modes, full.f.modes);
}

TEST(Reduce, ProjectsInitialStatesInTheInnerProductOfMass) {
    ContactProblem full = chain(n);
    full.u0 = scattered(n, 1, 2);
    const ReducedBasis basis = some_basis();
    full.v0 = basis.U * Vector::LinSpaced(p, -1, 2);
    const ContactProblem reduced = reduce(full, basis);
    // The error is M-orthogonal to the basis, and what the basis holds is kept.
    EXPECT_LT((basis.U.transpose() * full.M->to_dense() * (basis.U * reduced.u0 - full.u0)).norm(), 1e-12);
    EXPECT_LT((reduced.v0 - Vector::LinSpaced(p, -1, 2)).norm(), 1e-12);

    ContactProblem still = chain(n, -0.4, {.mass = false});
    still.u0 = full.u0;
    const ContactProblem at_rest = reduce(still, basis);
    EXPECT_LT((basis.U.transpose() * still.K.to_dense() * (basis.U * at_rest.u0 - still.u0)).norm(), 1e-12);
}

TEST(Reduce, TakesRowsThatAreOffOnlyWhereTheDualBasisIsZero) {
    ContactProblem full = chain(n);
    full.c.modes(3, 0) = -infinity;
    ReducedBasis basis = some_basis();
    EXPECT_THROW(reduce(full, basis), InputError);
    basis.U_lambda.row(3).setZero();
    full.c.modes.array() = full.c.modes.array().max(-1e300);
    full.c.modes(3, 0) = -infinity;
    ContactProblem on = full;
    on.c.modes(3, 0) = 7;
    EXPECT_EQ(reduce(full, basis).c.modes, reduce(on, basis).c.modes);
}

TEST(Reduce, WithoutDualBasisHasNoContact) {
    const ContactProblem reduced = reduce(chain(n), {scattered(n, p), DenseMatrix(m, 0)});
    EXPECT_EQ(reduced.constraints(), 0);
    EXPECT_EQ(reduced.B.cols(), p);
    EXPECT_NO_THROW(validate(reduced));
}

TEST(Reduce, RefusesANegativeDualBasis) {
    ReducedBasis basis = some_basis();
    basis.U_lambda(5, 1) = -1e-9;
    EXPECT_THROW(reduce(chain(n), basis), InputError);
    EXPECT_THROW(reduce(ChainFamily(n), basis), InputError);
}

TEST(Reduce, ProjectsSparseModesAndRefusesALoadWithoutModes) {
    ContactProblem full = chain(n, -0.4);
    DenseMatrix modes = DenseMatrix::Zero(n, 2);
    modes(3, 0) = 2;
    modes(n - 1, 1) = -1;
    const auto swell = [](double t, Side, VectorRef out) { out << std::sin(t), 1 + t; };
    full.f = AffineVector(SparseMatrix(modes.sparseView()), swell);
    const ReducedBasis basis = some_basis();
    const ContactProblem reduced = reduce(full, basis);
    EXPECT_LE((reduced.f.at(0.4) - basis.U.transpose() * full.f.at(0.4)).norm(), 1e-14);
    full.f = AffineVector::function(n, [](double, Side, VectorRef out) { out.setOnes(); });
    try {
        (void)reduce(full, basis);
        FAIL() << "a function of its full size was reduced";
    } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()).find("reduce: f is a function"), std::string::npos) << error.what();
    }
}

TEST(Reduce, InfSupConstantSeesDependentRows) {
    ReducedBasis basis = some_basis();
    EXPECT_GT(inf_sup_constant(reduce(chain(n), basis)), 1e-4);
    basis.U_lambda.col(2) = basis.U_lambda.col(0) + basis.U_lambda.col(1);
    EXPECT_LT(inf_sup_constant(reduce(chain(n), basis)), 1e-14);
}

/// A chain that notes which rows its gap is asked for, and can be told that it must not be built again.
class WatchedFamily final : public ChainFamily {
public:
    using ChainFamily::ChainFamily;
    ContactProblem at(const Parameter& gamma) const override {
        if (closed) throw std::logic_error("the full problem was built");
        return ChainFamily::at(gamma);
    }
    void gap(const Parameter& gamma, std::span<const Index> rows, VectorRef out) const override {
        asked.assign(rows.begin(), rows.end());
        ChainFamily::gap(gamma, rows, out);
    }
    mutable std::vector<Index> asked;
    bool closed = false;
};

TEST(ReducedFamily, AnswersLikeReductionAtEachParameterFromTouchedRowsOnly) {
    for (const bool filled : {true, false}) {  // the dual basis is kept dense or sparse
        WatchedFamily family(n);
        ReducedBasis basis = some_basis();
        basis.U_lambda.row(2).setZero();
        basis.U_lambda.row(9).setZero();
        if (!filled)
            for (Index i = 0; i < m; ++i)
                for (Index j = 0; j < p_lambda; ++j)
                    if ((i + j) % 6 != 0) basis.U_lambda(i, j) = 0;
        const auto reduced = reduce(Shared<ContactFamily>::borrowed(family), basis);
        const Parameter first = Eigen::Vector2d(0.1, 0.3), second = Eigen::Vector2d(0.25, 0.6);
        const ContactProblem expected = reduce(family.at(second), basis);
        family.closed = true;
        const ContactProblem a = reduced->at(first), b = reduced->at(second);
        EXPECT_LT((b.c.modes - expected.c.modes).norm(), 1e-14);
        EXPECT_GT((a.c.modes - b.c.modes).norm(), 1e-3);
        EXPECT_TRUE(a.K.same_storage(b.K) && a.M->same_storage(*b.M) && a.B.same_storage(b.B));
        std::vector<Index> touched;
        for (Index i = 0; i < m; ++i)
            if (basis.U_lambda.row(i).maxCoeff() > 0) touched.push_back(i);
        EXPECT_EQ(family.asked, touched);
        Vector two(2);
        reduced->gap(second, std::vector<Index>{3, 1}, two);
        EXPECT_EQ(two[0], b.c.modes(3, 0));
        EXPECT_EQ(two[1], b.c.modes(1, 0));
        EXPECT_EQ(reduced->names(), family.names());
    }
}

/// A chain whose load depends on gamma too.
class LoadedFamily final : public ChainFamily {
public:
    using ChainFamily::ChainFamily;
    std::vector<std::string> varying() const override { return {"c", "f"}; }
    ContactProblem at(const Parameter& gamma) const override {
        ContactProblem problem = ChainFamily::at(gamma);
        problem.f.modes *= 1 + gamma[0];
        return problem;
    }
};

TEST(ReducedFamily, ProjectsTheFullProblemWhereMoreThanTheGapVaries) {
    const LoadedFamily family(n);
    const ReducedBasis basis = some_basis();
    const auto reduced = reduce(family, basis);
    EXPECT_EQ(reduced->varying(), family.varying());
    for (const double height : {0.05, 0.2}) {
        const Parameter gamma = Eigen::Vector2d(height, 0.4);
        const ContactProblem expected = reduce(family.at(gamma), basis), found = reduced->at(gamma);
        EXPECT_EQ(found.f.modes, expected.f.modes);
        EXPECT_EQ(found.c.modes, expected.c.modes);
    }
    ReducedBasis wrong = basis;
    wrong.U_lambda(5, 1) = -1e-9;
    EXPECT_THROW(reduce(family, wrong), InputError);
}

TEST(ReducedFamily, OfASingleProblemKeepsAMovingGap) {
    ContactProblem full = chain(n);
    full.c = AffineVector(full.c.modes, [](double t, Side, VectorRef out) { out[0] = 1 + t; });
    const ReducedBasis basis = some_basis();
    const ContactProblem reduced = reduce(SingleProblem(full), basis)->at({});
    EXPECT_LT((reduced.c.at(0.5) - basis.U_lambda.transpose() * full.c.at(0.5)).norm(), 1e-14);
}

TEST(ReducedRun, InUnitBasesIsTheFullRun) {
    const ContactProblem full = chain(n);
    const ContactProblem same = reduce(full, {identity(n), identity(m)});
    ContactWorkspace contact(std::make_shared<DenseContact>());
    const TimeGrid grid = TimeGrid::until(6, 0.05);
    const MarchReport a = integrate(Bdf2(), full, grid, contact), b = integrate(Bdf2(), same, grid, contact);
    ASSERT_EQ(a.outcome, Outcome::converged);
    ASSERT_EQ(b.outcome, Outcome::converged);
    EXPECT_GT(a.most_active, 2);
    EXPECT_LT((a.final_state.y - b.final_state.y).norm(), 1e-11);
    EXPECT_EQ(a.first_contact_step, b.first_contact_step);
}

TEST(ReducedRun, InTheSpanOfAFullRunReproducesIt) {
    const ContactProblem full = chain(n, -0.02);
    ContactWorkspace contact(std::make_shared<DenseContact>());
    const TimeGrid grid = TimeGrid::until(0.8, 0.05);  // 16 states span less than the whole space
    Trajectory states(full, grid.steps);
    const Observer record = states.observer();
    const MarchReport march = integrate(Bdf2(), full, grid, contact, {&record, 1});
    ASSERT_EQ(march.outcome, Outcome::converged);
    ASSERT_GT(march.most_active, 0);
    const ReducedBasis basis = modal_basis(full, {states.u(), identity(m)});
    ASSERT_LT(basis.primal_size(), n);
    const ContactProblem reduced = reduce(full, basis);
    Trajectory reduced_states(reduced, grid.steps);
    const Observer record_reduced = reduced_states.observer();
    ASSERT_EQ(integrate(Bdf2(), reduced, grid, contact, {&record_reduced, 1}).outcome, Outcome::converged);
    EXPECT_LT((basis.U * reduced_states.u() - states.u()).cwiseAbs().maxCoeff(), 1e-9);
}

}  // namespace
}  // namespace tact
