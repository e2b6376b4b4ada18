#include "../../bench/studies/omission/omission.hpp"

#include <gtest/gtest.h>

#include "../../lib/errors.hpp"

namespace tact::bench {
namespace {

const Json& row_of(const Json& rows, const char* field, const std::string& value) {
    for (const Json& row : rows)
        if (row[field] == value) return row;
    throw InputError("no row of " + value);
}

TEST(Omission, ProgramsLinkWhatTheirWorkNeedsAndNoMore) {
    const Json json = run_omission({true, {"mass-on-stop", "draped-string-at-rest"}});
    const auto left_out = [&](const char* program) {
        std::vector<std::string> names = row_of(json["programs"], "program", program)["left_out"];
        return names;
    };
    const std::vector<std::string> by_marches{"KLU", "CHOLMOD", "OpenBLAS", "BLAS", "GSL", "HDF5", "IPOPT"};
    std::vector<std::string> by_queries = by_marches;
    by_queries.insert(by_queries.begin(), "SUNDIALS");
    EXPECT_EQ(left_out("tact-online-reduced"), by_queries);
    EXPECT_EQ(left_out("tact-online-march"), by_marches);
    EXPECT_EQ(left_out("tact-online-static"), (std::vector<std::string>{"SUNDIALS", "GSL", "HDF5", "IPOPT"}));

    for (const Json& row : json["rows"]) {
        const std::string part = row["part"];
        const bool moves = row["scene"] == "mass-on-stop";
        EXPECT_TRUE(part != "time integrator" || row["used"] == moves);
        EXPECT_TRUE(part != "active set" || row["used"] == true);
        EXPECT_TRUE(part != "D" || row["used"] == false);
    }
    EXPECT_EQ(json["costs"].size(), 3u);
    EXPECT_NE(omission_markdown(json).find("tact-online-march"), std::string::npos);
    EXPECT_THROW(run_omission({true, {"membranes"}}), InputError);
}

}  // namespace
}  // namespace tact::bench
