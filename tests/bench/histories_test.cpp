#include "../../bench/studies/histories/histories.hpp"

#include <gtest/gtest.h>

namespace tact::bench {
namespace {

double range(const Json& numbers) {
    const auto values = numbers.get<std::vector<double>>();
    const auto [least, largest] = std::ranges::minmax(values);
    return largest - least;
}

double distance(const Json& a, const Json& b) {
    double most = 0;
    for (std::size_t k = 0; k < a.size(); ++k)
        most = std::max(most, std::abs(a[k].get<double>() - b[k].get<double>()));
    return most;
}

TEST(Histories, OfThePlatesAndTheStaticMembraneAreCloseButForSingularVectors) {
    const Json json = run_histories({.small = true, .scenes = {"static-obstacle", "two-plates"}});
    ASSERT_EQ(json["rows"].size(), 3u);
    ASSERT_EQ(json["slices"].size(), 2u);
    ASSERT_EQ(json["surfaces"].size(), 3u) << "the membrane, and both plates";
    for (const Json& surface : json["surfaces"]) {
        EXPECT_EQ(surface["full"].size(), 41u * 41u);
        EXPECT_LT(distance(surface["full"], surface["reduced"]), 0.4 * range(surface["full"]));
        EXPECT_EQ(surface["full"][0], 0) << "the corner is fixed";
    }
    for (const Json& slice : json["slices"]) {
        EXPECT_LT(distance(slice["full"], slice["reduced"]), 0.1 * range(slice["full"]));
        for (std::size_t k = 0; k < slice["x"].size(); ++k)  // up to the interpolation between nodes
            EXPECT_GE(slice["full"][k].get<double>(), slice["obstacle"][k].get<double>() - 1e-6);
    }
    ASSERT_EQ(json["histories"].size(), 1u);
    const Json& plates = json["histories"][0];
    ASSERT_EQ(plates["points"].size(), 2u);
    for (const Json& point : plates["points"]) {
        ASSERT_EQ(point["full"].size(), plates["t"].size());
        EXPECT_LT(distance(point["full"], point["reduced"]), distance(point["full"], point["singular_vectors"]));
    }
    const Json& row = json["rows"][2];
    EXPECT_LT(row["relative_error_percent"], 10);
    EXPECT_GT(row["singular_vectors_error_percent"], 10 * row["relative_error_percent"].get<double>());
    ASSERT_EQ(json["claims"].size(), 1u) << "the static paper figures have no singular vectors";
    const Json& claim = json["claims"][0];
    EXPECT_NEAR(claim["figure"],
                row["singular_vectors_error_percent"].get<double>() / row["relative_error_percent"].get<double>(),
                1e-9);
    EXPECT_EQ(claim["holds"], row["relative_error_percent"] < 2);
    EXPECT_NE(histories_table(json).find("11, 12"), std::string::npos);
    EXPECT_NE(histories_markdown(json).find("histories.svg"), std::string::npos);
}

}  // namespace
}  // namespace tact::bench
