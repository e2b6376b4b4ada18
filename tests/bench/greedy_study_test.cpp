#include "../../bench/studies/greedy/greedy_study.hpp"

#include <gtest/gtest.h>

#include <map>

#include "../../lib/errors.hpp"

namespace tact::bench {
namespace {

TEST(GreedyStudy, HasARowForEveryBasisAndTheClaimsBesideThem) {
    const Json json = run_greedy({.small = true, .scenes = {"static-obstacle"}});
    EXPECT_EQ(json["size"], "small");
    std::map<std::string, int> rows;
    for (const Json& row : json["rows"]) {
        ++rows[row["selection"]];
        for (const char* field : {"scene", "p", "p_lambda", "test_parameters", "worst_error_percent",
                                  "median_error_percent", "worst_error_norm"})
            ASSERT_TRUE(row.contains(field)) << field;
        EXPECT_LE(row["median_error_percent"], row["worst_error_percent"]);
        EXPECT_NEAR(row["worst_error_norm"].get<double>(), 0.1 * std::sqrt(row["worst_error_percent"].get<double>()),
                    1e-9);
    }
    ASSERT_EQ(rows.size(), 10u) << "seven sets of weights, another grid, the true error and random samples";
    EXPECT_EQ(rows["(1,0,0)"], 5);
    EXPECT_EQ(rows["true error"], 5);
    EXPECT_EQ(rows["Latin hypercube"], 20);
    EXPECT_EQ(json["claims"].size(), 4u);
    for (const Json& claim : json["claims"])
        for (const char* field : {"scene", "claim", "paper", "figure", "holds"})
            EXPECT_TRUE(claim.contains(field)) << claim;
    EXPECT_NE(greedy_table(json).find("true error"), std::string::npos);
    EXPECT_NE(greedy_markdown(json).find("## Claims"), std::string::npos);
    EXPECT_THROW(run_greedy({.small = true, .scenes = {"two-plates"}}), InputError);
}

}  // namespace
}  // namespace tact::bench
