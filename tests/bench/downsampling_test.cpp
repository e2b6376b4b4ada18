#include "../../bench/studies/downsampling/downsampling.hpp"

#include <gtest/gtest.h>

#include <map>

namespace tact::bench {
namespace {

TEST(Downsampling, KeepsWhatIsAskedAndSaysWhatItCosts) {
    const Json json = run_downsampling({.small = true});
    std::map<std::string, int> rows;
    for (const Json& row : json["rows"]) {
        ++rows[row["selection"]];
        if (row["stride"].is_number()) {  // the plates rest for the first ten steps
            EXPECT_NEAR(row["snapshots"].get<double>(), 2000 / row["stride"].get<double>(), 10);
        }
        EXPECT_NEAR(row["share_percent"].get<double>(), row["snapshots"].get<double>() / 20, 1e-12);
        EXPECT_LE(row["p"], row["p_wanted"]);
        EXPECT_LE(row["p_lambda"], row["dual_snapshots"]);
        EXPECT_GT(row["relative_error_percent"], 0);
        EXPECT_LT(row["relative_error_percent"], 50);
    }
    EXPECT_EQ(rows.size(), 3u);
    EXPECT_EQ(rows["every k-th step"], 9);
    EXPECT_EQ(rows["tolerance"], 6);
    EXPECT_EQ(json["claims"].size(), 3u);
    EXPECT_NE(downsampling_table(json).find("tolerance"), std::string::npos);
    EXPECT_NE(downsampling_markdown(json).find("downsampling.svg"), std::string::npos);
}

}  // namespace
}  // namespace tact::bench
