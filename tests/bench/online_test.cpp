#include "../../bench/studies/online/online.hpp"

#include <gtest/gtest.h>

#include "../../lib/errors.hpp"

namespace tact::bench {
namespace {

TEST(OnlineStudy, RowsHoldWhatTheyShould) {
    const Json json = run_online({.small = true, .scenes = {"static-obstacle"}});
    ASSERT_EQ(json["rows"].size(), 2u);
    for (const Json& row : json["rows"]) {
        EXPECT_EQ(row["same_bits"], true);
        EXPECT_LT(row["parameter_error"], 1e-9);
        EXPECT_GE(row["bound"]["least"], 1 - 1e-9);
        EXPECT_EQ(row["bound"]["below"], 0);
        EXPECT_LE(row["estimate"]["least"], row["estimate"]["median"]);
        EXPECT_EQ(row["tests"], 12);
        EXPECT_GT(row["file_bytes"], 3600 * 8);
    }
    EXPECT_LT(json["rows"][1]["error_percent"], json["rows"][0]["error_percent"]);
    EXPECT_EQ(online_table(json).find("NO"), std::string::npos);
}

TEST(OnlineStudy, RefusesScenesThatDoNotExist) {
    EXPECT_THROW((void)run_online({.small = true, .scenes = {"plates"}}), InputError);
}

}  // namespace
}  // namespace tact::bench
