#include "tact/bench/growth_study.hpp"

#include <gtest/gtest.h>

#include "tact/lib/errors.hpp"

namespace tact::bench {
namespace {

TEST(GrowthStudy, QueriesAndStepsGrowLinearly) {
    const Json json = run_growth_study({true, {}});
    ASSERT_EQ(json["rows"].size(), 8u);
    for (const Json& row : json["rows"]) {
        ASSERT_TRUE(row["exponent"].is_number()) << row;
        // Not how fast, but that work is proportional to what was asked.
        if (row["with"] != "queries" && row["with"] != "steps") continue;
        EXPECT_NEAR(row["exponent"].get<double>(), 1, 0.4) << row;
    }
    EXPECT_NE(growth_markdown(json).find("| queries"), std::string::npos) << growth_markdown(json);
    EXPECT_THROW(run_growth_study({true, {"two-plates"}}), InputError);
}

}  // namespace
}  // namespace tact::bench
