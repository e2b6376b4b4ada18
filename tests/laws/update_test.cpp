// PreparedContact::update: the answers are those of a fresh prepare, for every strategy that takes it.
#include <gtest/gtest.h>

#include "strategies.hpp"

namespace tact::laws {
namespace {

class Update : public testing::TestWithParam<Strategy> {};

TEST_P(Update, GivesTheAnswersOfAFreshPrepare) {
    std::mt19937 random(11);
    for (const Rows rows : GetParam().takes)
        for (int k = 0; k < 12; ++k) {
            const Index m = 1 + k % 6, n = 2 * m + 1;
            const QuadraticProgram first = random_program(random, n, m, rows);
            const Matrix B(Matrix(first.B).to_sparse());
            const auto updated = GetParam().solver->prepare(Matrix(Matrix(first.A).to_sparse()), B);
            Vector u = Vector::Zero(n), lambda = Vector::Zero(m);
            (void)updated->solve(first.b, first.c, {u, lambda});
            for (int change = 0; change < 3; ++change) {
                DenseMatrix A = first.A;
                A.diagonal() += (0.1 + change) * A.diagonal().cwiseProduct(random_vector(random, n).cwiseAbs());
                const Matrix next(Matrix(A).to_sparse());
                if (!updated->update(next)) continue;
                const Vector b = random_vector(random, n);
                const Solved fresh = solve(*GetParam().solver, next, B, b, first.c, Vector::Zero(m));
                Vector guess = lambda;
                const auto report = updated->solve(b, first.c, {u, guess});
                if (fresh.report.outcome != Outcome::converged || report.outcome == Outcome::cycling) continue;
                ASSERT_EQ(report.outcome, Outcome::converged);
                ASSERT_LE(report.kkt.largest(), 1e-11);
                ASSERT_LE((u - fresh.u).norm(), 1e-10 * (1 + u.norm()));
                ASSERT_LE((guess - fresh.lambda).norm(), 1e-9 * (1 + fresh.lambda.norm()));
                lambda = guess;
            }
        }
}

TEST_P(Update, RefusesAnotherSize) {
    std::mt19937 random(12);
    const QuadraticProgram small = random_program(random, 5, 2, GetParam().takes.front());
    const QuadraticProgram large = random_program(random, 7, 2, GetParam().takes.front());
    const auto prepared =
        GetParam().solver->prepare(Matrix(Matrix(small.A).to_sparse()), Matrix(Matrix(small.B).to_sparse()));
    EXPECT_FALSE(prepared->update(Matrix(Matrix(large.A).to_sparse())));
    Vector u = Vector::Zero(5), lambda = Vector::Zero(2);
    EXPECT_EQ(prepared->solve(small.b, small.c, {u, lambda}).outcome, Outcome::converged);
}

TEST(UpdateOfDirectStrategies, IsTaken) {
    std::mt19937 random(13);
    const QuadraticProgram qp = random_program(random, 9, 3, Rows::bounds);
    const Matrix A(Matrix(qp.A).to_sparse()), B(Matrix(qp.B).to_sparse());
    for (const Strategy& strategy : strategies()) {
        const std::string name = strategy.name;
        const bool direct = name == "KluActiveSet" || name == "SchurContact" || name == "DenseContact" ||
                            name == "AutomaticContact" || name == "RefinedContact";
        if (direct) {
            EXPECT_TRUE(strategy.solver->prepare(A, B)->update(scaled(1.5, A))) << name;
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Strategies, Update, testing::ValuesIn(strategies()),
                         [](const auto& instance) { return std::string(instance.param.name); });

}  // namespace
}  // namespace tact::laws
