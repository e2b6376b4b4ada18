#include "../../../rom/greedy/greedy.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "../../../contact/automatic.hpp"
#include "../../../contact/dense/dense_contact.hpp"
#include "../../../integrators/sundials/bdf2.hpp"
#include "../../../lib/scenes/membrane.hpp"
#include "../../../rom/error/relative_error.hpp"
#include "../../../rom/greedy/sampling.hpp"
#include "../chain.hpp"

namespace tact {
namespace {

using testing::chain;
using testing::ChainFamily;

const ChainFamily still(41, {.mass = false, .moving_load = false});
const ChainFamily moving(41);
const TrainingMethod marching{std::make_shared<Bdf2>(), TimeGrid{0.1, 60, 0}};

/// The dense solver for full problems too; sparse matrices of this size it takes.
TrainingContact dense() { return {std::make_shared<DenseContact>(), std::make_shared<DenseContact>()}; }

TrainingOptions over_grid(const ContactFamily& family, int iterations) {
    TrainingOptions options;
    options.candidates = tensor_grid(family.lower(), family.upper(), {5, 4});
    options.max_iterations = iterations;
    options.sizes = [](int samples) { return BasisSizes{4 * samples, 3 * samples}; };
    return options;
}

TEST(PaperSizes, GrowFromTwoToAHundredInTenSamples) {
    EXPECT_EQ(paper_sizes(1).p, 2);
    EXPECT_EQ(paper_sizes(2).p, 12);  // 2 + floor(98 / 9)
    EXPECT_EQ(paper_sizes(9).p, 89);
    EXPECT_EQ(paper_sizes(10).p_lambda, 100);
}

void expect_no_repeats(const TrainingResult& result) {
    for (std::size_t i = 0; i < result.history.size(); ++i)
        for (std::size_t j = 0; j < i; ++j) EXPECT_NE(result.history[i].gamma, result.history[j].gamma);
}

TEST(Train, NeverSamplesTwiceAndTakesTheLargestIndicator) {
    for (const bool dynamic : {false, true}) {
        const ChainFamily& family = dynamic ? moving : still;
        TrainingOptions options = over_grid(family, 6);
        const TrainingResult result = train(family, dynamic ? marching : TrainingMethod{}, dense(), options);
        ASSERT_EQ(result.outcome, Outcome::converged);
        EXPECT_EQ(result.reason, StopReason::iterations);
        ASSERT_EQ(result.history.size(), 6u);
        expect_no_repeats(result);
        EXPECT_EQ(result.history[0].gamma, options.candidates[static_cast<std::size_t>(nearest_to_centre(
                                               options.candidates, family.lower(), family.upper()))]);
        for (std::size_t k = 0; k + 1 < 6; ++k) {
            const auto& indicators = result.history[k].indicators;
            double largest = 0;
            std::size_t where = 0, skipped = 0;
            for (std::size_t j = 0; j < indicators.size(); ++j) {
                if (std::isnan(indicators[j])) ++skipped;
                if (indicators[j] > largest) largest = indicators[where = j];
            }
            EXPECT_EQ(skipped, k + 1);
            EXPECT_EQ(result.history[k].max_indicator, largest);
            EXPECT_EQ(result.history[k + 1].gamma, options.candidates[where]);
        }
        EXPECT_TRUE(result.history.back().indicators.empty());  // the last iteration searches no further
        EXPECT_LT(result.history[4].max_indicator, result.history[0].max_indicator);
    }
}

TEST(Train, InStaticsReproducesItsSamplesFromUncompressedSnapshots) {
    const TrainingResult result = train(still, {}, dense(), over_grid(still, 5));
    ASSERT_EQ(result.outcome, Outcome::converged);
    EXPECT_LE(result.basis.primal_size(), 5);
    EXPECT_EQ(result.basis.dual_size(), result.history.back().p_lambda);
    ContactWorkspace full(dense().full), reduced(dense().reduced);
    for (const TrainingIteration& iteration : result.history) {
        const ContactProblem problem = still.at(iteration.gamma);
        const StaticSolution u = solve_static(problem, full),
                             q = solve_static(result.reduced->at(iteration.gamma), reduced);
        ASSERT_GT(u.report.active, 0);
        EXPECT_LT(relative_error(problem, u, result.basis, q).norm_percent, 1e-6);
    }
}

/// The paper's third claim, on a coarse membrane and after five samples.
TEST(Train, InTimeGetsCloserWithMoreSamples) {
    const MembraneFamily membrane(24, Motion::dynamic);
    const TrainingMethod method{std::make_shared<Bdf2>(), TimeGrid::until(2, 0.02)};
    const Parameter asked = Eigen::Vector2d(0.37, 0.43);  // not a candidate
    ContactWorkspace full_contact(dense().full);
    const ContactProblem full = membrane.at(asked);
    Trajectory u(full, method.grid.steps);
    const Observer record = u.observer();
    const MarchReport march = integrate(*method.integrator, full, method.grid, full_contact, {&record, 1});
    ASSERT_EQ(march.outcome, Outcome::converged);
    ASSERT_GT(march.most_active, 10);
    std::vector<double> errors;
    for (const int iterations : {1, 5}) {
        TrainingOptions options = over_grid(membrane, iterations);
        options.sizes = paper_sizes;
        const TrainingResult result = train(membrane, method, dense(), options);
        ASSERT_EQ(result.outcome, Outcome::converged);
        EXPECT_EQ(result.basis.primal_size(), paper_sizes(iterations).p);
        EXPECT_GE(result.basis.U_lambda.minCoeff(), 0);
        const ContactProblem reduced = result.reduced->at(asked);
        EXPECT_TRUE(reduced.M->diagonal_entries() && reduced.K.diagonal_entries());
        ContactWorkspace contact(dense().reduced);
        Trajectory q(reduced, method.grid.steps);
        const Observer record_reduced = q.observer();
        ASSERT_EQ(integrate(*method.integrator, reduced, method.grid, contact, {&record_reduced, 1}).outcome,
                  Outcome::converged);
        errors.push_back(relative_error(full, u, result.basis, q).norm_percent);
    }
    EXPECT_LT(errors[1], 0.2 * errors[0]);
    EXPECT_LT(errors[1], 5);
}

/// What is asked of the static scene: at most .03 % (eq. 16) with 20 samples of the paper's grid.
TEST(Train, FullSizeStaticMembraneHasTheErrorAskedFor) {
    const MembraneFamily membrane(200);
    TrainingOptions options;
    options.candidates = tensor_grid(membrane.lower(), membrane.upper(), {10, 10});
    options.max_iterations = 20;
    const TrainingContact contact{std::make_shared<AutomaticContact>(), std::make_shared<DenseContact>()};
    const TrainingResult result = train(membrane, {}, contact, options);
    ASSERT_EQ(result.outcome, Outcome::converged);
    expect_no_repeats(result);
    ContactWorkspace full(contact.full), reduced(contact.reduced);
    double worst = 0;
    for (const Parameter& gamma : latin_hypercube(membrane.lower(), membrane.upper(), 40, 1)) {
        const ContactProblem problem = membrane.at(gamma);
        const StaticSolution u = solve_static(problem, full), q = solve_static(result.reduced->at(gamma), reduced);
        ASSERT_EQ(q.report.outcome, Outcome::converged);
        worst = std::max(worst, relative_error(problem, u, result.basis, q).squared_percent);
    }
    EXPECT_LT(worst, 0.03);
}

TEST(Train, IsTheSameEachTime) {
    const TrainingResult a = train(moving, marching, dense(), over_grid(moving, 3));
    const TrainingResult b = train(moving, marching, dense(), over_grid(moving, 3));
    EXPECT_EQ(a.basis.U, b.basis.U);
    EXPECT_EQ(a.basis.U_lambda, b.basis.U_lambda);
    for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(a.history[k].gamma, b.history[k].gamma);
}

TEST(Train, TellsTheBasesOfEveryIteration) {
    TrainingOptions options = over_grid(moving, 3);
    std::vector<Index> sizes;
    options.on_basis = [&](const TrainingResult& so_far) {
        sizes.push_back(so_far.basis.primal_size());
        EXPECT_EQ(so_far.history.size(), sizes.size());
        EXPECT_EQ(so_far.reduced->at(options.candidates[0]).size(), sizes.back());
    };
    const TrainingResult result = train(moving, marching, dense(), options);
    EXPECT_EQ(sizes, (std::vector<Index>{4, 8, 12}));
    EXPECT_EQ(result.basis.primal_size(), 12);
}

TEST(Train, KeepsFewerSnapshotsWithATolerance) {
    TrainingOptions options = over_grid(moving, 1);
    const TrainingResult all = train(moving, marching, dense(), options);
    EXPECT_EQ(all.history[0].snapshots, marching.grid.steps);
    options.snapshots.tolerance = 0.2;
    const TrainingResult few = train(moving, marching, dense(), options);
    EXPECT_LT(few.history[0].snapshots, marching.grid.steps / 2);
    EXPECT_GT(few.history[0].snapshots, 4);
}

TEST(Train, OfASingleProblemIsReproduction) {
    const SingleProblem single(chain(24, -0.05));
    TrainingOptions options;
    options.max_iterations = 1;
    options.sizes = [](int) { return BasisSizes{24, 8}; };
    const TrainingResult result = train(single, marching, dense(), options);
    EXPECT_EQ(result.reason, StopReason::iterations);
    EXPECT_EQ(result.history.size(), 1u);
    EXPECT_EQ(result.history[0].gamma.size(), 0);
    EXPECT_EQ(result.reduced->at({}).constraints(), result.basis.dual_size());
    options.max_iterations = 3;
    EXPECT_EQ(train(single, marching, dense(), options).reason, StopReason::candidates_exhausted);
}

TEST(Train, WithoutContactHasNoDualBasisAndStopsAtOnce) {
    ContactProblem free = chain(24, -1e6);
    const SingleProblem single(free);
    TrainingOptions options;
    options.candidates = {Parameter(), Parameter()};
    const TrainingResult result = train(single, marching, dense(), options);
    EXPECT_EQ(result.outcome, Outcome::converged);
    EXPECT_EQ(result.basis.dual_size(), 0);
    EXPECT_EQ(result.reduced->at({}).constraints(), 0);
}

TEST(Train, StopsBelowEpsilonOfTheFirstIndicator) {
    TrainingOptions options = over_grid(still, 20);
    options.epsilon = 0.3;
    const TrainingResult result = train(still, {}, dense(), options);
    ASSERT_EQ(result.reason, StopReason::tolerance);
    const auto& history = result.history;
    ASSERT_GE(history.size(), 2u);
    EXPECT_LT(history.back().max_indicator, 0.3 * history.front().max_indicator);
    for (std::size_t k = 1; k + 1 < history.size(); ++k)
        EXPECT_GE(history[k].max_indicator, 0.3 * history.front().max_indicator);
}

TEST(Train, FollowsAnOracleAndAGivenFirstSample) {
    TrainingOptions options = over_grid(still, 3);
    const Parameter first = Eigen::Vector2d(0.2, 0.21);  // not a candidate
    options.first = first;
    options.oracle = [](const Parameter& gamma, const ReducedBasis&, const ReducedStates& states) {
        EXPECT_EQ(states.size(), 1);
        return gamma[0] + 10 * gamma[1];
    };
    const TrainingResult result = train(still, {}, dense(), options);
    EXPECT_EQ(result.history[0].gamma, first);
    EXPECT_EQ(result.history[1].gamma, options.candidates[19]);
    EXPECT_EQ(result.history[2].gamma, options.candidates[18]);
}

TEST(Train, ReportsProgressOfEveryStageAndStopsWhenToldTo) {
    TrainingOptions options = over_grid(moving, 3);
    std::vector<std::string> stages;
    options.observer = [&](const TrainingProgress& progress) {
        EXPECT_EQ(progress.iterations, 3);
        EXPECT_GE(progress.fraction, 0);
        EXPECT_LE(progress.fraction, 1);
        if (stages.empty() || stages.back() != progress.stage) stages.emplace_back(progress.stage);
        return Flow::proceed;
    };
    ASSERT_EQ(train(moving, marching, dense(), options).outcome, Outcome::converged);
    const std::vector<std::string> once{"full run", "POD", "dual basis", "candidates"};
    ASSERT_EQ(stages.size(), 11u);
    for (std::size_t k = 0; k < stages.size(); ++k) EXPECT_EQ(stages[k], once[k % 4]);

    for (const std::string& stage : once) {
        options.observer = [&](const TrainingProgress& progress) {
            return progress.iteration == 2 && progress.stage == stage ? Flow::stop : Flow::proceed;
        };
        const TrainingResult result = train(moving, marching, dense(), options);
        EXPECT_EQ(result.outcome, Outcome::stopped) << stage;
        EXPECT_EQ(result.reason, StopReason::stopped) << stage;
        EXPECT_GT(result.basis.primal_size(), 0) << stage;
    }
}

/// Contact that fails after a while, to see what training makes of it.
class FailingContact final : public ContactSolver {
public:
    explicit FailingContact(int good_solves) : good_solves_(good_solves) {}
    std::unique_ptr<PreparedContact> prepare(const Matrix& A, const Matrix& B) const override {
        return std::make_unique<Prepared>(DenseContact().prepare(A, B), good_solves_);
    }

private:
    struct Prepared final : PreparedContact {
        Prepared(std::unique_ptr<PreparedContact> inner_, int left_) : inner(std::move(inner_)), left(left_) {}
        ContactReport solve(const ConstVectorRef& b, const ConstVectorRef& c, ContactPoint point) override {
            if (left-- > 0) return inner->solve(b, c, point);
            ContactReport report;
            report.outcome = Outcome::iteration_limit;
            return report;
        }
        std::unique_ptr<PreparedContact> inner;
        int left;
    };
    int good_solves_;
};

TEST(Train, EndsHonestlyWhereARunDoesNotConverge) {
    const TrainingOptions options = over_grid(moving, 3);
    // One prepared solver for the first step and one for the others: 8 of the latter is step 9 + 1.
    TrainingResult result =
        train(moving, marching, {std::make_shared<FailingContact>(8), std::make_shared<DenseContact>()}, options);
    EXPECT_EQ(result.outcome, Outcome::iteration_limit);
    EXPECT_EQ(result.reason, StopReason::full_run_failed);
    EXPECT_EQ(result.failed_step, 10);
    EXPECT_EQ(result.failed_gamma, result.history[0].gamma);
    EXPECT_EQ(result.basis.primal_size(), 0);

    result =
        train(moving, marching, {std::make_shared<DenseContact>(), std::make_shared<FailingContact>(100)}, options);
    EXPECT_EQ(result.reason, StopReason::reduced_run_failed);
    EXPECT_EQ(result.failed_gamma, options.candidates[1]);  // the first march takes 59 of the 100
    EXPECT_EQ(result.failed_step, 43);
    EXPECT_GT(result.basis.primal_size(), 0);

    result = train(still, {}, {std::make_shared<FailingContact>(0), std::make_shared<DenseContact>()},
                   over_grid(still, 2));
    EXPECT_EQ(result.reason, StopReason::full_run_failed);
    EXPECT_EQ(result.failed_step, 0);
}

TEST(Train, TakesAnyDualBasisAndSupremizers) {
    /// Eigen's dense factors, for sparse matrices too.
    class AsDense final : public LinearSolver {
        std::unique_ptr<const Factor> factorize(const Matrix& A) const override {
            return DenseLinearSolver().factorize(Matrix(A.to_dense()));
        }
    };
    for (const DualBasis& recipe :
         {snapshot_cone(), cone_projected_greedy(), selected_rows(), touched_rows(), singular_vectors()}) {
        TrainingOptions options = over_grid(moving, 1);
        options.sizes = [](int) { return BasisSizes{20, 6}; };
        options.dual_basis = recipe;
        const TrainingResult plain = train(moving, marching, dense(), options);
        ASSERT_EQ(plain.outcome, Outcome::converged);
        EXPECT_EQ(plain.basis.primal_size(), 20);
        EXPECT_GE(plain.basis.dual_size(), 6);
        options.supremizers = {.share = 0.2, .linear = std::make_shared<AsDense>(), .a = 15};
        const TrainingResult enriched = train(moving, marching, dense(), options);
        ASSERT_EQ(enriched.outcome, Outcome::converged);
        EXPECT_EQ(enriched.basis.primal_size(), 20);
        EXPECT_NE(enriched.basis.U, plain.basis.U);
    }
}

TEST(Train, LeavesOutModesBelowATolerance) {
    TrainingOptions options = over_grid(moving, 1);
    options.sizes = [](int) { return BasisSizes{20, 6}; };
    const TrainingResult all = train(moving, marching, dense(), options);
    options.pod_tolerance = 1e-2;
    const TrainingResult few = train(moving, marching, dense(), options);
    EXPECT_LT(few.basis.primal_size(), all.basis.primal_size());
    EXPECT_GE(few.basis.primal_size(), 2);
}

TEST(Train, RefusesWhatDoesNotFit) {
    const auto refused = [](const TrainingOptions& options) {
        EXPECT_THROW((void)train(moving, marching, dense(), options), InputError);
    };
    const TrainingOptions good = over_grid(moving, 2);
    TrainingOptions bad = good;
    bad.candidates[3] = Vector::Zero(3);
    refused(bad);
    bad = good;
    bad.candidates[3][1] = std::nan("");
    refused(bad);
    bad = good;
    bad.candidates.clear();
    refused(bad);
    bad = good;
    bad.max_iterations = 0;
    refused(bad);
    bad = good;
    bad.epsilon = 1;
    refused(bad);
    bad = good;
    bad.snapshots.primal = 0;
    refused(bad);
    bad = good;
    bad.indicator_stride = 0;
    refused(bad);
    bad = good;
    bad.sizes = nullptr;
    refused(bad);
    bad = good;
    bad.dual_basis = nullptr;
    refused(bad);
    bad = good;
    bad.pod_tolerance = 1;
    refused(bad);
    bad = good;
    bad.supremizers.share = 1;
    refused(bad);
    bad.supremizers.share = 0.5;  // and no linear solver
    refused(bad);
    bad = good;
    bad.sizes = [](int) { return BasisSizes{61, 2}; };  // 60 snapshots
    refused(bad);
    bad = good;
    bad.weights.negativity = -1;
    refused(bad);
    bad = good;
    bad.threads = 0;
    refused(bad);
}

}  // namespace
}  // namespace tact
