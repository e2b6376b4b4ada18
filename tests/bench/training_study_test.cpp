#include "../../bench/studies/training/training_study.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "../../bench/harness/peak_memory.hpp"

namespace tact::bench {
namespace {

TEST(PeakMemory, SeesABlockThatIsGoneAgain) {
    if (!reset_peak_memory() || !peak_memory()) GTEST_SKIP() << "this system does not say";
    const double before = *peak_memory();
    constexpr std::size_t size = 100'000'000;
    { const std::vector<char> block(size, 1); }
    EXPECT_GT(*peak_memory() - before, 0.9 * size);
    ASSERT_TRUE(reset_peak_memory());
    EXPECT_LT(*peak_memory() - before, 0.5 * size);
}

TEST(TrainingStudy, AddsUpByPartAndPaysAfterSoManyQueries) {
    const Json json = run_training({.small = true, .scenes = {"static-obstacle", "two-plates"}});
    ASSERT_EQ(json["rows"].size(), 6u) << "five full solves, and one";
    ASSERT_EQ(json["scenes"].size(), 2u);
    for (const Json& scene : json["scenes"]) {
        EXPECT_TRUE(scene["two_threads_same_bits"]);
        double last = 0;
        for (const Json& row : json["rows"]) {
            if (row["scene"] != scene["scene"]) continue;
            double sum = 0;
            for (const char* part : {"full_run", "pod", "dual_basis", "projection", "candidates"})
                sum += row[std::string(part) + "_seconds"].get<double>();
            EXPECT_GE(sum, last);
            last = sum;
        }
        EXPECT_GT(last, 0);
        EXPECT_LE(last, 1.01 * scene["training_seconds"].get<double>() + 1e-3);
        EXPECT_NEAR(scene["break_even_queries"].get<double>(),
                    scene["training_seconds"].get<double>() /
                        (scene["full_seconds"].get<double>() - scene["reduced_seconds"].get<double>()),
                    1e-6);
    }
    EXPECT_NE(training_table(json).find("two-plates"), std::string::npos);
    EXPECT_NE(training_markdown(json).find("training.svg"), std::string::npos);
}

}  // namespace
}  // namespace tact::bench
