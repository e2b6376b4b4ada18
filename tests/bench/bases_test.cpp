#include "../../bench/studies/bases/bases.hpp"

#include <gtest/gtest.h>

#include "../../bench/harness/paper_study.hpp"
#include "../../bench/harness/reference_runs.hpp"
#include "../../contact/dense/dense_contact.hpp"
#include "../../lib/errors.hpp"

namespace tact::bench {
namespace {

// worst_errors marches the full problem again and lifts in double precision.
TEST(ReferenceRuns, AgreeWithTheErrorsOfRunsMadeAnew) {
    StudyScene scene = study_scene("dynamic-obstacle", 12);
    scene.t_end = 0.8;
    const Scheme scheme = paper_scheme(scene);
    TrainingOptions options;
    options.first = Vector::Constant(2, 0.4);
    options.max_iterations = 1;
    options.sizes = [](int) { return BasisSizes{8, 4}; };
    const TrainingResult trained =
        train(scene.family, {scheme.integrator, scheme.grid},
              {std::make_shared<DenseContact>(), std::make_shared<DenseContact>()}, options);
    ASSERT_EQ(trained.outcome, Outcome::converged);
    const std::vector<Parameter> tests = tensor_grid(scene.family->lower(), scene.family->upper(), {3, 1});
    ContactWorkspace full(std::make_shared<DenseContact>()), reduced(std::make_shared<DenseContact>());
    const WorstErrors anew = worst_errors(scene, scheme, trained.basis, *trained.reduced, tests, full, reduced);
    const ReducedErrors errors =
        ReferenceRuns(scene, scheme, tests).errors(trained.basis, *trained.reduced, std::make_shared<DenseContact>());
    ASSERT_EQ(errors.squared_percent.size(), 3u);
    EXPECT_NEAR(errors.worst() / anew.squared_percent, 1, 1e-5);
    EXPECT_NEAR(errors.median() / anew.median_squared_percent, 1, 1e-5);
    EXPECT_NEAR(errors.penetration / anew.penetration_share, 1, 1e-4);
}

TEST(PaperStudy, TestParametersAreNotSampledOnes) {
    const std::vector<Parameter> gammas{Vector::Constant(2, 1.0), Vector::Constant(2, 3.0)};
    EXPECT_EQ(without(gammas, {Vector::Constant(2, 3.0)}).size(), 1u);
    const std::vector<Parameter> none(1);
    EXPECT_EQ(without(none, none).size(), 1u) << "a scene without parameters keeps its run";
}

TEST(Bases, RowsHaveTheFieldsAndTheFrontIsOne) {
    const Json json = run_bases({true, 1, {"static-obstacle"}, {"NNMF", "touched rows"}});
    ASSERT_EQ(json["rows"].size(), 8u);  // two recipes on four training sets
    for (const Json& row : json["rows"]) {
        for (const char* field : {"scene", "integrator", "training", "dual_basis", "p", "p_lambda",
                                  "supremizer_share", "compliance", "members", "outcome"})
            EXPECT_TRUE(row.contains(field)) << field;
        EXPECT_EQ(row["outcome"], "converged");
        EXPECT_GT(row["error_percent"], 0);
        EXPECT_LT(row["error_percent"], 5);
        EXPECT_LT(row["kkt_residual"], 1e-9);
        EXPECT_LE(row["error_min"], row["error_percent"].get<double>() * (1 + 1e-12));
        EXPECT_GE(row["error_max"], row["error_percent"].get<double>() * (1 - 1e-12));
        if (!row["pareto"].get<bool>()) continue;
        for (const Json& other : json["rows"])
            EXPECT_FALSE(other["error_percent"] < row["error_percent"] && other["us_per_step"] < row["us_per_step"]);
    }
    EXPECT_NE(bases_markdown(json).find("| touched rows"), std::string::npos);
}

TEST(Bases, RejectsBadInput) {
    EXPECT_THROW(run_bases({true, 0}), InputError);
    EXPECT_THROW(run_bases({true, 1, {"plates"}}), InputError);
    EXPECT_THROW(run_bases({true, 1, {}, {"wavelets"}}), InputError);
}

}  // namespace
}  // namespace tact::bench
