#include "../../bench/studies/speedup/speedup.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "../../bench/harness/report.hpp"
#include "../../bench/peers/interior_point.hpp"
#include "../../lib/errors.hpp"
#include "../../lib/io/write_file.hpp"

namespace tact::bench {
namespace {

TEST(Speedup, RowHasTheFieldsAndTheirMeaning) {
    const Json json = run_speedup({.small = true, .repeats = 1, .scenes = {"static-obstacle"}});
    EXPECT_EQ(json["size"], "small");
    ASSERT_EQ(json["rows"].size(), 2u);
    EXPECT_EQ(json["rows"][0]["method"], "ours");
    EXPECT_EQ(json["rows"][1]["method"], "the paper's");
    EXPECT_EQ(json["rows"][1]["p_lambda"], json["rows"][1]["p"]) << "the paper's bases are of equal size";
    EXPECT_EQ(json["rows"][0]["full_seconds"], json["rows"][1]["full_seconds"]) << "one full run for both";
    const Json& row = json["rows"][0];
    for (const char* field : {"scene",
                              "method",
                              "unknowns",
                              "contact_constraints",
                              "steps",
                              "p",
                              "p_lambda",
                              "full_seconds",
                              "full_cold_seconds",
                              "full_method",
                              "full_klu_refactor_seconds",
                              "interior_point_seconds",
                              "reduced_seconds",
                              "training_seconds",
                              "speedup",
                              "speedup_vs_klu_refactor",
                              "speedup_vs_interior_point",
                              "paper_speedup",
                              "relative_error_percent",
                              "relative_error_norm",
                              "max_penetration",
                              "max_kkt_residual_full",
                              "extrapolated"})
        EXPECT_TRUE(row.contains(field)) << field;
    EXPECT_EQ(row["p"], 5);
    EXPECT_EQ(row["unknowns"], 3600);
    EXPECT_GT(row["speedup"], 1);
    EXPECT_EQ(row["interior_point_seconds"].is_null(), !interior_point());
    EXPECT_LT(row["relative_error_percent"], 1);
    EXPECT_NEAR(row["relative_error_norm"].get<double>(),
                0.1 * std::sqrt(row["relative_error_percent"].get<double>()), 1e-9);
    EXPECT_LT(row["max_kkt_residual_full"], 1e-10);
    EXPECT_LT(row["full_klu_refactor_max_difference"], 1e-9);
    EXPECT_EQ(row["extrapolated"].size(), 0u);
    EXPECT_NE(speedup_markdown(json).find(" static-obstacle |"), std::string::npos) << speedup_markdown(json);
}

TEST(Speedup, OneMethodAloneIsOneRow) {
    const Json json = run_speedup({.small = true, .repeats = 1, .bases = "paper", .scenes = {"static-obstacle"}});
    ASSERT_EQ(json["rows"].size(), 1u);
    EXPECT_EQ(json["rows"][0]["method"], "the paper's");
}

TEST(Speedup, RejectsBadInput) {
    EXPECT_THROW(run_speedup({.small = true, .repeats = 0}), InputError);
    EXPECT_THROW(run_speedup({.small = true, .bases = "wavelets"}), InputError);
    EXPECT_THROW(run_speedup({.small = true, .scenes = {"plates"}}), InputError);
}

TEST(WriteStudy, AFolderThatCannotBeWrittenIsRefusedAtTheDoor) {
    const auto folder = std::filesystem::path(testing::TempDir()) / "tact_door";
    std::filesystem::remove_all(folder);
    check_out_folder(folder / "new" / "deep");
    EXPECT_TRUE(std::filesystem::is_empty(folder / "new" / "deep"));
    write_file(folder / "file", "in the way");
    EXPECT_THROW(check_out_folder(folder / "file"), InputError);
    EXPECT_THROW(check_out_folder(folder / "file" / "below"), InputError);
    std::filesystem::remove_all(folder);
}

TEST(WriteStudy, AFigureThatCannotBeDrawnLeavesTheDataAndSaysSo) {
    const auto folder = std::filesystem::path(testing::TempDir()) / "tact_write_study";
    std::filesystem::remove_all(folder);
    try {
        write_study(folder, "no-such-study", Json{{"rows", 1}}, "# page\n");
        FAIL() << "there is no script for it";
    } catch (const NumericalError& error) {
        EXPECT_NE(std::string(error.what()).find("no-such-study.svg"), std::string::npos) << error.what();
    }
    EXPECT_EQ(read_file(folder / "no-such-study.md"), "# page\n");
    EXPECT_FALSE(std::filesystem::exists(folder / "no-such-study.svg"));
    EXPECT_FALSE(std::filesystem::exists(folder / "no-such-study.svg.part"));
    std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace tact::bench
