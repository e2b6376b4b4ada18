// Laws that every contact strategy obeys, against the enumeration of all active sets.
#include <gtest/gtest.h>

#include <functional>
#include <memory>

#include "strategies.hpp"

namespace tact::laws {
namespace {

Solved solve(const ContactSolver& solver, const QuadraticProgram& qp, const Vector& guess) {
    return laws::solve(solver, Matrix(Matrix(qp.A).to_sparse()), Matrix(Matrix(qp.B).to_sparse()), qp.b, qp.c, guess);
}

class EveryStrategy : public testing::TestWithParam<Strategy> {
protected:
    /// Calls `law` on generated programs of every kind this strategy takes.
    void on_programs(int count, const std::function<void(std::mt19937&, const QuadraticProgram&)>& law) {
        for (const Rows rows : GetParam().takes) {
            std::mt19937 random(42);
            for (int k = 0; k < count; ++k) {
                const Index m = k % 7;
                const Index n = 2 * m + 1 + k % 3;
                law(random, random_program(random, n, m, rows));
                if (HasFatalFailure()) return;
            }
        }
    }
    bool may_give_up(const Solved& s) const {
        return !GetParam().always_ends && (s.report.outcome == Outcome::cycling);
    }
};

TEST_P(EveryStrategy, AgreesWithTheEnumerationOfAllActiveSets) {
    int given_up = 0, programs = 0;
    on_programs(120, [&](std::mt19937&, const QuadraticProgram& qp) {
        ++programs;
        const auto exact = by_enumeration(qp);
        ASSERT_TRUE(exact);
        const Solved s = solve(*GetParam().solver, qp, Vector::Zero(qp.c.size()));
        if (may_give_up(s)) {
            ++given_up;
            return;
        }
        ASSERT_EQ(s.report.outcome, Outcome::converged)
            << to_string(s.report.outcome) << " " << s.report.kkt.largest() << " m " << qp.c.size();
        ASSERT_LE(s.report.kkt.largest(), 1e-12);
        ASSERT_LE((s.u - exact->u).norm(), 1e-9 * (1 + exact->u.norm()));
        ASSERT_LE((s.lambda - exact->lambda).norm(), 1e-8 * (1 + exact->lambda.norm()));
    });
    EXPECT_LE(given_up, programs / 10);
}

TEST_P(EveryStrategy, TheReportedResidualsAreThoseOfTheData) {
    on_programs(20, [&](std::mt19937&, const QuadraticProgram& qp) {
        const Solved s = solve(*GetParam().solver, qp, Vector::Zero(qp.c.size()));
        if (may_give_up(s)) return;
        ASSERT_EQ(s.report.outcome, Outcome::converged);
        const auto kkt = kkt_residuals(Matrix(qp.A), Matrix(qp.B), qp.b, qp.c, s.u, s.lambda);
        ASSERT_NEAR(s.report.kkt.largest(), kkt.largest(), 1e-15);
        ASSERT_EQ(s.report.active, (s.lambda.array() > 0).count());
    });
}

TEST_P(EveryStrategy, AWarmStartDoesNotChangeTheAnswer) {
    on_programs(40, [&](std::mt19937& random, const QuadraticProgram& qp) {
        const Solved cold = solve(*GetParam().solver, qp, Vector::Zero(qp.c.size()));
        const Solved warm = solve(*GetParam().solver, qp, random_vector(random, qp.c.size()).cwiseMax(0));
        if (may_give_up(cold) || may_give_up(warm)) return;
        ASSERT_EQ(warm.report.outcome, Outcome::converged);
        ASSERT_LE((cold.u - warm.u).norm(), 1e-10 * (1 + cold.u.norm()));
    });
}

TEST_P(EveryStrategy, ScalingARowScalesItsMultiplierOnly) {
    on_programs(30, [&](std::mt19937& random, const QuadraticProgram& qp) {
        QuadraticProgram scaled = qp;
        const Vector factors = (3 * random_vector(random, qp.c.size())).array().exp();
        scaled.B = factors.asDiagonal() * qp.B;
        scaled.c = factors.cwiseProduct(qp.c);
        const Solved a = solve(*GetParam().solver, qp, Vector::Zero(qp.c.size()));
        const Solved b = solve(*GetParam().solver, scaled, Vector::Zero(qp.c.size()));
        if (may_give_up(a) || may_give_up(b)) return;
        ASSERT_EQ(b.report.outcome, Outcome::converged);
        ASSERT_LE((a.u - b.u).norm(), 1e-9 * (1 + a.u.norm()));
        ASSERT_LE((a.lambda - factors.cwiseProduct(b.lambda)).norm(), 1e-8 * (1 + a.lambda.norm()));
    });
}

TEST_P(EveryStrategy, ARowAtMinusInfinityIsSwitchedOff) {
    on_programs(30, [&](std::mt19937&, const QuadraticProgram& qp) {
        const Index m = qp.c.size();
        if (m == 0) return;
        QuadraticProgram off = qp, without = qp;
        off.c[m - 1] = -infinity;
        without.B = qp.B.topRows(m - 1).eval();
        without.c = qp.c.head(m - 1).eval();
        const Solved a = solve(*GetParam().solver, off, Vector::Zero(m));
        const Solved b = solve(*GetParam().solver, without, Vector::Zero(m - 1));
        if (may_give_up(a) || may_give_up(b)) return;
        ASSERT_EQ(a.report.outcome, Outcome::converged);
        ASSERT_EQ(a.lambda[m - 1], 0);
        ASSERT_LE((a.u - b.u).norm(), 1e-10 * (1 + a.u.norm()));
    });
}

TEST_P(EveryStrategy, TheOrderOfRowsAndUnknownsChangesNothing) {
    on_programs(30, [&](std::mt19937& random, const QuadraticProgram& qp) {
        const Index n = qp.A.rows(), m = qp.B.rows();
        Eigen::PermutationMatrix<Eigen::Dynamic> rows(m), unknowns(n);
        rows.setIdentity();
        unknowns.setIdentity();
        std::shuffle(rows.indices().begin(), rows.indices().end(), random);
        std::shuffle(unknowns.indices().begin(), unknowns.indices().end(), random);
        const QuadraticProgram other{unknowns * qp.A * unknowns.transpose(), rows * qp.B * unknowns.transpose(),
                                     unknowns * qp.b, rows * qp.c};
        const Solved a = solve(*GetParam().solver, qp, Vector::Zero(m));
        const Solved b = solve(*GetParam().solver, other, Vector::Zero(m));
        if (may_give_up(a) || may_give_up(b)) return;
        ASSERT_EQ(b.report.outcome, Outcome::converged);
        ASSERT_LE((unknowns * a.u - b.u).norm(), 1e-10 * (1 + a.u.norm()));
        ASSERT_LE((rows * a.lambda - b.lambda).norm(), 1e-8 * (1 + a.lambda.norm()));
    });
}

TEST_P(EveryStrategy, ARowTwiceIsRefusedGivenUpOrChangesNothing) {
    int solved = 0, programs = 0;
    on_programs(30, [&](std::mt19937&, const QuadraticProgram& qp) {
        const Index m = qp.c.size();
        if (m == 0) return;
        ++programs;
        QuadraticProgram twice = qp;
        twice.B.conservativeResize(m + 1, qp.B.cols());
        twice.c.conservativeResize(m + 1);
        twice.B.row(m) = 3 * qp.B.row(0);
        twice.c[m] = 3 * qp.c[0];
        Solved b;
        try {
            b = solve(*GetParam().solver, twice, Vector::Zero(m + 1));
        } catch (const InputError&) {
            return;  // rows that overlap are not its kind
        }
        if (b.report.outcome != Outcome::converged) {
            ASSERT_TRUE(!GetParam().always_ends) << to_string(b.report.outcome);
            ASSERT_EQ(b.u, Vector::Zero(b.u.size()));
            return;
        }
        ++solved;
        const auto exact = by_enumeration(qp);
        ASSERT_LE((exact->u - b.u).norm(), 1e-9 * (1 + b.u.norm()));
        ASSERT_NEAR(exact->lambda[0], b.lambda[0] + 3 * b.lambda[m], 1e-8 * (1 + exact->lambda.norm()));
    });
    if (GetParam().always_ends) {
        EXPECT_EQ(solved, programs);
    }
}

TEST_P(EveryStrategy, ManySolvesWithOnePreparationAgreeWithFreshOnes) {
    std::mt19937 random(7);
    const auto qp = random_program(random, 12, 5, GetParam().takes.front());
    const auto prepared =
        GetParam().solver->prepare(Matrix(Matrix(qp.A).to_sparse()), Matrix(Matrix(qp.B).to_sparse()));
    Vector u = Vector::Zero(12), lambda = Vector::Zero(5);
    for (int k = 0; k < 30; ++k) {
        QuadraticProgram next = qp;
        next.b = random_vector(random, 12);
        const auto report = prepared->solve(next.b, next.c, {u, lambda});
        if (!GetParam().always_ends && report.outcome == Outcome::cycling) continue;
        ASSERT_EQ(report.outcome, Outcome::converged);
        const auto exact = by_enumeration(next);
        ASSERT_LE((u - exact->u).norm(), 1e-9 * (1 + exact->u.norm()));
    }
}

TEST_P(EveryStrategy, NaNInABoundEndsAsAnOutcomeAndLeavesThePoint) {
    std::mt19937 random(3);
    auto qp = random_program(random, 7, 3, GetParam().takes.front());
    qp.c[1] = std::numeric_limits<double>::quiet_NaN();
    const Solved s = solve(*GetParam().solver, qp, Vector::Zero(3));
    EXPECT_NE(s.report.outcome, Outcome::converged);
    EXPECT_EQ(s.u, Vector::Zero(7));
    EXPECT_EQ(s.lambda, Vector::Zero(3));
}

TEST_P(EveryStrategy, NaNInAMatrixIsRefused) {
    std::mt19937 random(3);
    const auto qp = random_program(random, 7, 3, GetParam().takes.front());
    for (const bool in_A : {true, false}) {
        QuadraticProgram bad = qp;
        (in_A ? bad.A(2, 2) : bad.B(1, 1)) = std::numeric_limits<double>::quiet_NaN();
        EXPECT_THROW((void)solve(*GetParam().solver, bad, Vector::Zero(3)), InputError);
    }
}

TEST_P(EveryStrategy, NaNEndsAsAnOutcomeAndLeavesThePoint) {
    std::mt19937 random(3);
    auto qp = random_program(random, 7, 3, GetParam().takes.front());
    qp.b[2] = std::numeric_limits<double>::quiet_NaN();
    Vector u = Vector::Constant(7, 0.5), lambda = Vector::Zero(3);
    const auto prepared =
        GetParam().solver->prepare(Matrix(Matrix(qp.A).to_sparse()), Matrix(Matrix(qp.B).to_sparse()));
    const auto report = prepared->solve(qp.b, qp.c, {u, lambda});
    EXPECT_NE(report.outcome, Outcome::converged);
    EXPECT_EQ(u, Vector::Constant(7, 0.5));
    EXPECT_EQ(lambda, Vector::Zero(3));
}

TEST_P(EveryStrategy, SubnormalNumbersCountAsZero) {
    constexpr double tiny = 3 * std::numeric_limits<double>::denorm_min();
    const auto outcome = [&](const QuadraticProgram& qp) -> std::pair<std::string, Solved> {
        try {
            const Solved s = solve(*GetParam().solver, qp, Vector::Zero(qp.c.size()));
            return {std::string(to_string(s.report.outcome)), s};
        } catch (const InputError&) {
            return {"refused", {}};
        } catch (const NumericalError&) {
            return {"singular", {}};
        }
    };
    on_programs(20, [&](std::mt19937&, const QuadraticProgram& qp) {
        const Index n = qp.A.rows(), m = qp.c.size();
        using Change = std::function<void(QuadraticProgram&, double)>;
        std::vector<Change> changes{[](QuadraticProgram& p, double x) { p.A(0, 0) = x; },
                                    [&](QuadraticProgram& p, double x) {
                                        p.A(0, n - 1) = p.A(n - 1, 0) = x;
                                        p.A.diagonal() += qp.A.cwiseAbs().rowwise().sum();
                                    },
                                    [](QuadraticProgram& p, double x) { p.b[0] = x; },
                                    [](QuadraticProgram& p, double x) { p.b.setConstant(x); }};
        if (m > 0) {
            changes.push_back([](QuadraticProgram& p, double x) { p.B.row(0).setConstant(x); });
            changes.push_back([](QuadraticProgram& p, double x) {
                p.B.row(0).setConstant(-x);
                p.c[0] = -1;
            });
            changes.push_back([](QuadraticProgram& p, double x) { p.c[0] = x; });
            changes.push_back([](QuadraticProgram& p, double x) {
                p.b.setConstant(-x);
                p.c.setConstant(x);
            });
        }
        for (std::size_t k = 0; k < changes.size(); ++k) {
            QuadraticProgram subnormal = qp, zero = qp;
            changes[k](subnormal, tiny);
            changes[k](zero, 0);
            const auto [found, a] = outcome(subnormal);
            const auto [expected, b] = outcome(zero);
            if (may_give_up(a) || may_give_up(b)) continue;
            ASSERT_EQ(found, expected) << "change " << k << ", m " << m;
            if (found != "converged") continue;
            ASSERT_LE((a.u - b.u).norm(), 1e-9 * (1e-280 + b.u.norm())) << "change " << k;
            ASSERT_LE((a.lambda - b.lambda).norm(), 1e-8 * (1e-280 + b.lambda.norm())) << "change " << k;
        }
    });
}

TEST_P(EveryStrategy, AGuessOfAnyMagnitudeDoesNotChangeTheAnswer) {
    on_programs(10, [&](std::mt19937& random, const QuadraticProgram& qp) {
        const Solved cold = solve(*GetParam().solver, qp, Vector::Zero(qp.c.size()));
        if (may_give_up(cold)) return;
        for (const double size : {1e-300, 1e-60, 1e-20, 1e6}) {
            Vector u = size * random_vector(random, qp.A.rows()), lambda = Vector::Zero(qp.c.size());
            const auto prepared = GetParam().solver->prepare(Matrix(qp.A), Matrix(qp.B));
            const auto report = prepared->solve(qp.b, qp.c, {u, lambda});
            if (!GetParam().always_ends && report.outcome == Outcome::cycling) continue;
            ASSERT_EQ(report.outcome, Outcome::converged) << size;
            ASSERT_LE((cold.u - u).norm(), 1e-9 * (1 + cold.u.norm())) << size;
        }
    });
}

INSTANTIATE_TEST_SUITE_P(All, EveryStrategy, testing::ValuesIn(strategies()),
                         [](const auto& instance) { return std::string(instance.param.name); });

/// u of the one set of rows that fits, among all 2^m, each by a Cholesky factor of its block of B A^-1 B'.
Vector by_condensed_enumeration(const QuadraticProgram& qp) {
    const Eigen::LLT<DenseMatrix> factor(qp.A);
    const DenseMatrix W = factor.solve(qp.B.transpose()), S = qp.B * W;
    const Vector free = factor.solve(qp.b), g = qp.c - qp.B * free;
    std::vector<Index> rows;
    for (unsigned set = 0; set < 1U << g.size(); ++set) {
        rows.clear();
        for (Index i = 0; i < g.size(); ++i)
            if (set >> i & 1U) rows.push_back(i);
        const Vector lambda = DenseMatrix(S(rows, rows)).llt().solve(Vector(g(rows)));
        if (!rows.empty() && lambda.minCoeff() < 0) continue;
        const Vector gap = S(Eigen::all, rows) * lambda - g;
        if (gap.minCoeff() >= -1e-10) return free + W(Eigen::all, rows) * lambda;
    }
    return {};
}

TEST_P(EveryStrategy, AgreesWithTheCondensedEnumerationOfTwelveRows) {
    std::mt19937 random(12);
    for (int k = 0; k < 30; ++k) {
        const auto qp = random_program(random, 25, 9 + k % 4, GetParam().takes.back());
        const Solved s = solve(*GetParam().solver, qp, random_vector(random, qp.c.size()).cwiseMax(0));
        if (may_give_up(s)) continue;
        ASSERT_EQ(s.report.outcome, Outcome::converged);
        const Vector exact = by_condensed_enumeration(qp);
        ASSERT_EQ(exact.size(), 25);
        ASSERT_LE((s.u - exact).norm(), 1e-9 * (1 + exact.norm()));
    }
}

TEST(ContactSolvers, ExcludingConstraintsAreInfeasible) {
    // u >= 1 and -u >= 0
    QuadraticProgram qp{DenseMatrix::Identity(2, 2), DenseMatrix::Zero(2, 2), Vector::Zero(2), Vector(2)};
    qp.B(0, 0) = 1;
    qp.B(1, 0) = -1;
    qp.c << 1, 0;
    for (const std::shared_ptr<const ContactSolver>& solver :
         {std::shared_ptr<const ContactSolver>(std::make_shared<DenseContact>()),
          std::shared_ptr<const ContactSolver>(std::make_shared<SchurContact>())})
        EXPECT_EQ(solve(*solver, qp, Vector::Zero(2)).report.outcome, Outcome::infeasible);
}

TEST(ContactSolvers, DuplicateAndDependentRowsChangeNothing) {
    std::mt19937 random(11);
    for (int k = 0; k < 60; ++k) {
        const auto qp = random_program(random, 8, 4, Rows::general);
        QuadraticProgram more = qp;
        more.B.conservativeResize(6, 8);
        more.c.conservativeResize(6);
        more.B.row(4) = qp.B.row(1);
        more.c[4] = qp.c[1];
        more.B.row(5) = qp.B.row(0) + qp.B.row(2);
        more.c[5] = qp.c[0] + qp.c[2];
        const auto exact = by_enumeration(qp);
        for (const Strategy& s : strategies()) {
            // A singular basis is PrincipalPivoting's stated limit.
            if (!s.always_ends || s.takes.size() < 3 || std::string(s.name) == "PrincipalPivoting") continue;
            const Solved solved = solve(*s.solver, more, Vector::Zero(6));
            ASSERT_EQ(solved.report.outcome, Outcome::converged) << s.name;
            ASSERT_LE((solved.u - exact->u).norm(), 1e-8 * (1 + exact->u.norm())) << s.name;
        }
    }
}

TEST(ContactSolvers, SingularMatrixIsNamed) {
    const SparseMatrix singular(SparseMatrix(DenseMatrix::Ones(3, 3).sparseView()));
    EXPECT_THROW((void)SchurContact().prepare(Matrix(singular), Matrix::identity(3)), NumericalError);
}

}  // namespace
}  // namespace tact::laws
