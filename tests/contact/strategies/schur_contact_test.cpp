// The pool of the condensed strategy: many problems with one matrix, far from each other, in little memory.
#include "../../../contact/strategies/schur_contact.hpp"

#include <gtest/gtest.h>

#include <random>

#include "../../../contact/strategies/klu_active_set.hpp"
#include "../../../lib/scenes/membrane.hpp"

namespace tact {
namespace {

TEST(SchurContact, AFullPoolAndAFarGuessGiveWhatKluGives) {
    constexpr Index n = 24;
    const MembraneFamily family(n);
    const ContactProblem problem = family.at(Eigen::Vector2d(0.45, 0.4));
    const Vector b = Vector::Constant(n * n, -40.0 / ((n + 1) * (n + 1)));
    std::vector<Index> rows(static_cast<std::size_t>(n * n));
    for (Index i = 0; i < n * n; ++i) rows[static_cast<std::size_t>(i)] = i;
    // the default, and so little that rows are forgotten all the time
    for (const SchurOptions& options : {SchurOptions{}, SchurOptions{.pool_bytes = 30 * 30 * 8}}) {
        const auto schur = SchurContact(options).prepare(problem.K, problem.B);
        const auto klu = KluActiveSet().prepare(problem.K, problem.B);
        std::mt19937 random(1);
        std::uniform_real_distribution<double> uniform;
        Vector u = Vector::Zero(n * n), lambda = u, c(n * n);
        for (int k = 0; k < 40; ++k) {
            const double x = uniform(random), y = uniform(random);
            family.gap(Eigen::Vector2d(0.3 + 0.3 * x, 0.2 + 0.4 * y), rows, c);
            ASSERT_EQ(schur->solve(b, c, {u, lambda}).outcome, Outcome::converged);
            Vector v = Vector::Zero(n * n), multiplier = v;
            ASSERT_EQ(klu->solve(b, c, {v, multiplier}).outcome, Outcome::converged);
            ASSERT_LE((u - v).lpNorm<Eigen::Infinity>(), 1e-12);
            ASSERT_LE((lambda - multiplier).lpNorm<Eigen::Infinity>(), 1e-11);
        }
    }
}

}  // namespace
}  // namespace tact
