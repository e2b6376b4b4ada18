#include "../../bench/studies/growth/growth_study.hpp"

#include <gtest/gtest.h>

#include "../../lib/errors.hpp"

namespace tact::bench {
namespace {

TEST(GrowthStudy, EverySeriesHasItsPointsInOrderAndASlope) {
    const Json json = run_growth_study({true, {}});
    ASSERT_EQ(json["rows"].size(), 8u);
    for (const Json& row : json["rows"]) {
        ASSERT_TRUE(row["exponent"].is_number()) << row;
        EXPECT_GE(row["points"].size(), 2u);
        double last = 0;
        for (const Json& point : row["points"]) {
            EXPECT_GT(point["x"], last) << row;
            EXPECT_GT(point["seconds"], 0) << row;
            last = point["x"];
        }
    }
    EXPECT_NE(growth_markdown(json).find(" queries |"), std::string::npos) << growth_markdown(json);
    EXPECT_THROW(run_growth_study({true, {"two-plates"}}), InputError);
}

}  // namespace
}  // namespace tact::bench
