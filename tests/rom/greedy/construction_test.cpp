#include "../../../rom/greedy/construction.hpp"

#include <gtest/gtest.h>

#include "../../../contact/dense/dense_contact.hpp"
#include "../../../integrators/sundials/bdf2.hpp"
#include "../../../lib/scenes/membrane.hpp"
#include "../../../rom/bases/pod.hpp"
#include "../../../rom/greedy/sampling.hpp"

namespace tact {
namespace {

const TrainingContact contact{std::make_shared<DenseContact>(), std::make_shared<DenseContact>()};

TEST(Construction, GrowsToItsSizeWithTheSamplesAndStaysThere) {
    const Construction march = march_construction(150, 10), still = static_construction(20, 100);
    EXPECT_EQ(march.sizes(1).p, 15);
    EXPECT_EQ(march.sizes(10).p, 150);
    EXPECT_EQ(march.sizes(10).p_lambda, 75);
    EXPECT_EQ(march.sizes(20).p, 150);
    EXPECT_EQ(still.sizes(1).p, 1);
    EXPECT_EQ(still.sizes(100).p_lambda, 40);
    EXPECT_EQ(still.compliance, 0) << "statics are exact on their rows";
    EXPECT_EQ(paper_march_construction(100, 10).sizes(5).p, paper_sizes(5).p);
    EXPECT_EQ(paper_march_construction(40, 1).sizes(1).p_lambda, 40);
    EXPECT_THROW(march_construction(0, 1), InputError);
    EXPECT_THROW(static_construction(5, 0), InputError);
}

// Against the POD of the solutions at all candidates.
TEST(Train, InOrderEndsWithTheBasisOfAllItsSamples) {
    const MembraneFamily membrane(15);
    TrainingOptions options;
    options.candidates = tensor_grid(membrane.lower(), membrane.upper(), {3, 3});
    options.max_iterations = 9;
    options.selection = Selection::in_order;
    options = static_construction(5, 9).applied_to(options);
    const TrainingResult in_order = train(membrane, {}, contact, options);
    ASSERT_EQ(in_order.outcome, Outcome::converged);
    EXPECT_EQ(in_order.reason, StopReason::iterations);
    ASSERT_EQ(in_order.history.size(), 9u);
    for (std::size_t k = 0; k < 9; ++k) EXPECT_EQ(in_order.history[k].gamma, options.candidates[k]);
    EXPECT_EQ(in_order.history[3].p, 0) << "bases are built at the end";
    EXPECT_TRUE(in_order.history[3].indicators.empty());
    EXPECT_EQ(in_order.basis.primal_size(), 5);
    EXPECT_LE(in_order.basis.dual_size(), 10);
    DenseMatrix X(membrane.at(options.candidates[0]).size(), 9);
    for (Index k = 0; k < 9; ++k) {
        ContactWorkspace workspace(contact.full);
        X.col(k) = solve_static(membrane.at(options.candidates[static_cast<std::size_t>(k)]), workspace).u;
    }
    const DenseMatrix U = pod(X, {.rank = 5}).modes;
    EXPECT_LT((in_order.basis.U - U * (U.transpose() * in_order.basis.U)).norm(), 1e-6);
    for (const Parameter& gamma : options.candidates) {
        ContactWorkspace workspace(contact.reduced);
        EXPECT_EQ(solve_static(in_order.reduced->at(gamma), workspace).report.outcome, Outcome::converged);
    }
}

}  // namespace
}  // namespace tact
