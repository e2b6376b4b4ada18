#include "../../bench/studies/tradeoff/tradeoff.hpp"

#include <gtest/gtest.h>

#include "../../lib/errors.hpp"

namespace tact::bench {
namespace {

TEST(Tradeoff, FinerGridsAreCloserToTheReferenceAndBreakEvenFollowsFromTheRows) {
    const Json json = run_tradeoff({true, {"static-obstacle"}});
    std::vector<Json> full, reduced;
    for (const Json& row : json["rows"]) (row["model"] == "full" ? full : reduced).push_back(row);
    ASSERT_EQ(full.size(), 2u);
    EXPECT_LT(full[1]["error_percent"], 0.2 * full[0]["error_percent"].get<double>()) << "order 2 in h, squared";
    EXPECT_TRUE(full[1]["training_model"].get<bool>());
    EXPECT_EQ(reduced.size(), 4u);
    for (const Json& entry : json["break_even"]) {
        if (entry["full"].is_null()) {
            EXPECT_TRUE(entry["queries"].is_null());
            EXPECT_LT(entry["error_percent"], full[1]["error_percent"]);
            continue;
        }
        EXPECT_GE(entry["error_percent"], full[1]["error_percent"]);
    }
    ASSERT_EQ(json["rivals"].size(), 1u);
    const Json& rival = json["rivals"][0];
    EXPECT_TRUE(rival["training_model"] == full[1]);
    for (const Json& row : full)  // no coarser full model that is as accurate is cheaper
        if (row["n"] < full[1]["n"] && row["error_percent"] <= rival["reduced"]["error_percent"]) {
            ASSERT_TRUE(rival["full"].is_object());
            EXPECT_LE(rival["full"]["seconds"], row["seconds"]);
        }
    EXPECT_NE(tradeoff_markdown(json).find("From how many queries"), std::string::npos);
    EXPECT_THROW(run_tradeoff({true, {"plates"}}), InputError);
}

}  // namespace
}  // namespace tact::bench
