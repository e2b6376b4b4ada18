// What the chooser takes, why, and when it changes its mind.
#include "../../contact/automatic.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include <Eigen/Eigenvalues>

#include "../../contact/prepare/matrix_facts.hpp"
#include "../../contact/strategies/klu_active_set.hpp"
#include "../../lib/scenes/membrane.hpp"
#include "../../lib/sparse/lanczos.hpp"

namespace tact {
namespace {

struct Obstacle {
    Matrix K, B;
    Vector b, c;
};

Obstacle obstacle(Index n, const Parameter& gamma) {
    const MembraneFamily family(n);
    const ContactProblem problem = family.at(gamma);
    Obstacle all{problem.K, problem.B, Vector(n * n), Vector(n * n)};
    all.b.setConstant(-10.0 / static_cast<double>((n + 1) * (n + 1)));
    std::vector<Index> rows(static_cast<std::size_t>(n * n));
    for (Index i = 0; i < n * n; ++i) rows[static_cast<std::size_t>(i)] = i;
    family.gap(gamma, rows, all.c);
    return all;
}

struct Solved {
    ContactReport report;
    Vector u;
};

Solved solve(PreparedContact& prepared, const Obstacle& o) {
    Solved s{{}, Vector::Zero(o.b.size())};
    Vector lambda = Vector::Zero(o.c.size());
    s.report = prepared.solve(o.b, o.c, {s.u, lambda});
    return s;
}

TEST(AutomaticContact, GivesUpMultigridForTheFactorWhenOneMatrixIsAskedForOften_KluAgrees) {
    const Obstacle first = obstacle(24, Eigen::Vector2d(0.45, 0.4));
    AutomaticOptions options;
    options.solves_before_factor = 4;
    const auto prepared = AutomaticContact(options).prepare(first.K, first.B);
    const auto klu = KluActiveSet().prepare(first.K, first.B);
    std::vector<std::string_view> strategies, reasons;
    for (int k = 0; k < 12; ++k) {
        const Obstacle o = obstacle(24, Eigen::Vector2d(0.45 + 0.005 * (k % 3), 0.4));
        const Solved s = solve(*prepared, o);
        ASSERT_EQ(s.report.outcome, Outcome::converged);
        ASSERT_LE(s.report.kkt.largest(), 1e-12);
        EXPECT_LE((s.u - solve(*klu, o).u).lpNorm<Eigen::Infinity>(), 1e-12);
        if (strategies.empty() || strategies.back() != s.report.strategy) {
            strategies.push_back(s.report.strategy);
            reasons.push_back(s.report.reason);
        }
    }
    EXPECT_EQ(strategies, (std::vector<std::string_view>{"multigrid active set", "Schur complement"}));
    EXPECT_NE(reasons.front(), reasons.back());
    EXPECT_FALSE(prepared->reads_guess());
}

TEST(AutomaticContact, GivesUpAnIterationThatIsSlowAgainAndAgain) {
    const Obstacle o = obstacle(60, Eigen::Vector2d(0.45, 0.4));
    AutomaticOptions options;
    options.sweepable = 1e9;  // so that sweeps are taken where they are slow
    const auto prepared = AutomaticContact(options).prepare(o.K, o.B);
    std::vector<std::string_view> strategies;
    for (int k = 0; k < 4; ++k) {
        const Solved s = solve(*prepared, o);
        ASSERT_EQ(s.report.outcome, Outcome::converged);
        strategies.push_back(s.report.strategy);
    }
    EXPECT_EQ(strategies,
              (std::vector<std::string_view>{"colour SOR", "colour SOR", "colour SOR", "Schur complement"}));
}

TEST(AutomaticContact, TakesTheFactorAtOnceWhereItIsNoLargerThanTheMatrix) {
    // a string of 1000 nodes over an obstacle at -1 under a load that presses it down, in order and shuffled
    constexpr Index n = 1000;
    Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, Index> order(n);
    order.setIdentity();
    for (int shuffled : {0, 1}) {
        std::mt19937 random(3);
        if (shuffled) std::shuffle(order.indices().begin(), order.indices().end(), random);
        std::vector<Eigen::Triplet<double>> entries;
        for (Index i = 0; i < n; ++i) {
            entries.emplace_back(order.indices()[i], order.indices()[i], 2.2);
            if (i + 1 < n)
                for (const auto& [a, b] : {std::pair(i, i + 1), std::pair(i + 1, i)})
                    entries.emplace_back(order.indices()[a], order.indices()[b], -1);
        }
        SparseMatrix A(n, n);
        A.setFromTriplets(entries.begin(), entries.end());
        const Obstacle o{Matrix(A), Matrix::identity(n), Vector::Constant(n, -0.3), Vector::Constant(n, -1)};
        const Solved s = solve(*AutomaticContact().prepare(o.K, o.B), o);
        EXPECT_EQ(s.report.outcome, Outcome::converged);
        EXPECT_EQ(s.report.strategy, "Schur complement") << shuffled;
        EXPECT_LE((s.u - solve(*KluActiveSet().prepare(o.K, o.B), o).u).lpNorm<Eigen::Infinity>(), 1e-13);
    }
}

TEST(AutomaticContact, DoesWhatItsOptionsSay) {
    const Obstacle o = obstacle(20, Eigen::Vector2d(0.45, 0.4));
    const auto strategy = [&](const AutomaticOptions& options) {
        const Solved s = solve(*AutomaticContact(options).prepare(o.K, o.B), o);
        EXPECT_EQ(s.report.outcome, Outcome::converged);
        EXPECT_FALSE(s.report.reason.empty());
        return s.report.strategy;
    };
    EXPECT_EQ(strategy({}), "multigrid active set");
    EXPECT_EQ(strategy({.never = {ContactStrategy::multigrid_active_set}}), "Schur complement");
    EXPECT_EQ(strategy({.always = ContactStrategy::projected_cg}), "projected CG");
    EXPECT_EQ(strategy({.small = 400}), "dense Goldfarb-Idnani");
    EXPECT_EQ(strategy({.always = ContactStrategy::principal_pivoting}), "principal pivoting");
}

const std::vector<ContactStrategy> every_strategy{
    ContactStrategy::diagonal,           ContactStrategy::dense,        ContactStrategy::klu_active_set,
    ContactStrategy::colour_sor,         ContactStrategy::projected_cg, ContactStrategy::multigrid_active_set,
    ContactStrategy::interior_point,     ContactStrategy::schur,        ContactStrategy::orthogonal,
    ContactStrategy::principal_pivoting, ContactStrategy::proximal};

/// A free chain pressed on a stop at its end: A is singular, u falls from 0 and the stop bears the whole load.
Obstacle free_chain(Index n) {
    SparseMatrix A(n, n), B(1, n);
    for (Index i = 0; i + 1 < n; ++i) {
        A.coeffRef(i, i) += 1;
        A.coeffRef(i + 1, i + 1) += 1;
        A.coeffRef(i, i + 1) -= 1;
        A.coeffRef(i + 1, i) -= 1;
    }
    B.insert(0, 0) = 1;
    return {Matrix(A), Matrix(B), Vector::Constant(n, -1), Vector::Zero(1)};
}

/// Whatever single one is left, and whatever pair is forbidden: an answer by one that is allowed, or InputError at prepare.
TEST(AutomaticContact, NeverLeavesWhatIsLeft) {
    const Index n = 320;
    for (const auto& forbidden :
         {std::vector{ContactStrategy::schur, ContactStrategy::interior_point}, std::vector{ContactStrategy::schur},
          std::vector{ContactStrategy::schur, ContactStrategy::orthogonal},
          std::vector{ContactStrategy::schur, ContactStrategy::klu_active_set},
          std::vector{ContactStrategy::klu_active_set, ContactStrategy::interior_point}}) {
        const Obstacle o = free_chain(n);
        const Solved s = solve(*AutomaticContact({.never = forbidden}).prepare(o.K, o.B), o);
        ASSERT_EQ(s.report.outcome, Outcome::converged) << to_string(s.report.outcome);
        for (Index i = 0; i < n; ++i) {  // u_i - u_i-1 is the load beyond i
            const double exact = -0.5 * static_cast<double>(i * (2 * n - 1 - i));
            ASSERT_NEAR(s.u[i], exact, 1e-8 * static_cast<double>(n * n)) << i;
        }
    }
    const Obstacle o = obstacle(20, Eigen::Vector2d(0.45, 0.4));
    const Vector expected = solve(*AutomaticContact().prepare(o.K, o.B), o).u;
    for (const ContactStrategy left : every_strategy) {
        std::vector<ContactStrategy> forbidden = every_strategy;
        std::erase(forbidden, left);
        std::unique_ptr<PreparedContact> prepared;
        try {
            prepared = AutomaticContact({.never = forbidden}).prepare(o.K, o.B);
        } catch (const InputError&) {
            continue;
        }
        const Solved s = solve(*prepared, o);
        ASSERT_EQ(s.report.outcome, Outcome::converged) << static_cast<int>(left) << to_string(s.report.outcome);
        EXPECT_LE((s.u - expected).norm(), 1e-8) << static_cast<int>(left);
    }
    EXPECT_THROW((void)AutomaticContact({.never = every_strategy}).prepare(o.K, o.B), InputError);
    SparseMatrix skew = o.K.to_sparse();
    skew.coeffRef(0, 1) *= 1.5;
    EXPECT_THROW((void)AutomaticContact({.never = every_strategy}).prepare(Matrix(skew), o.B), InputError);
    const Solved pivoted =
        solve(*AutomaticContact({.never = {ContactStrategy::klu_active_set}}).prepare(Matrix(skew), o.B), o);
    EXPECT_EQ(pivoted.report.outcome, Outcome::converged);
    EXPECT_LE((pivoted.u - solve(*KluActiveSet().prepare(Matrix(skew), o.B), o).u).norm(), 1e-9);
}

/// No other strategy follows the one that is asked for, though it does not solve the problem.
TEST(AutomaticContact, AlwaysIsFollowedByNoOther) {
    const Obstacle o = free_chain(320);
    EXPECT_THROW((void)solve(*AutomaticContact({.always = ContactStrategy::schur}).prepare(o.K, o.B), o),
                 NumericalError);
    EXPECT_THROW((void)solve(*AutomaticContact({.always = ContactStrategy::orthogonal}).prepare(o.K, o.B), o),
                 NumericalError);
    // Constraints that exclude each other: the default lets others judge, and they are named.
    Obstacle excluded = obstacle(20, Eigen::Vector2d(0.45, 0.4));
    DenseMatrix B = DenseMatrix::Zero(2, 400);
    B(0, 0) = 1;
    B(1, 0) = -1;
    excluded.B = Matrix(B);
    excluded.c = Vector::Constant(2, 1);
    for (const ContactStrategy strategy : {ContactStrategy::schur, ContactStrategy::klu_active_set,
                                           ContactStrategy::interior_point, ContactStrategy::orthogonal}) {
        const Solved s = solve(*AutomaticContact({.always = strategy}).prepare(excluded.K, excluded.B), excluded);
        EXPECT_NE(s.report.outcome, Outcome::converged);
        EXPECT_TRUE(s.report.fallback.empty()) << s.report.fallback;
    }
}

TEST(MatrixFacts, BracketTheConditionThatEigenFinds) {
    const Matrix K = obstacle(12, Eigen::Vector2d(0.45, 0.4)).K;
    for (const double mass : {0.0, 0.1, 3.0}) {
        const Matrix A = combine(1, K, mass, Matrix(Matrix::identity(K.rows()).to_sparse()));
        const Vector scale = A.main_diagonal().cwiseSqrt().cwiseInverse();
        const DenseMatrix scaled = scale.asDiagonal() * A.to_dense() * scale.asDiagonal();
        const Vector values = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(scaled).eigenvalues();
        const double condition = values.maxCoeff() / values.minCoeff();
        const MatrixFacts facts = matrix_facts(A);
        EXPECT_TRUE(facts.m_matrix && facts.positive_diagonal);
        EXPECT_LE(facts.condition_above, condition);
        EXPECT_GE(facts.condition_below, condition);
        EXPECT_EQ(facts.well_conditioned(A, 20), condition <= 20);
    }
    EXPECT_FALSE(matrix_facts(scaled(-1, K)).m_matrix);
}

}  // namespace
}  // namespace tact
