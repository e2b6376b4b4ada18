#include "../../bench/harness/report.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "../../bench/harness/timing.hpp"

namespace tact::bench {
namespace {

TEST(Report, Digits) {
    EXPECT_EQ(digits(Json(nullptr)), "-");
    EXPECT_EQ(digits(0.0123456), "0.0123");
    EXPECT_EQ(digits(2229.4), "2229");
    EXPECT_EQ(digits(1520304.0), "1520304");
    EXPECT_EQ(digits(3.9e8), "3.9e+08");
    EXPECT_EQ(digits(1.5e-9, 2), "1.5e-09");
}

TEST(Report, SecondsWithUnits) {
    EXPECT_EQ(with_unit(Json(nullptr)), "-");
    EXPECT_EQ(with_unit(2.5e-7), "0.25 us");
    EXPECT_EQ(with_unit(1.234e-3), "1.23 ms");
    EXPECT_EQ(with_unit(852.0), "852 s");
}

TEST(Report, TableIsMarkdownOfEqualWidth) {
    EXPECT_EQ(table({{"scene", "a"}, {"p", "1200"}}),
              "| scene |    a |\n"
              "|-------|-----:|\n"
              "| p     | 1200 |\n");
}

TEST(Report, MachineSaysWhatWasMeasuredOn) {
    const Json here = machine();
    for (const char* field : {"cpu", "cores", "compiler", "flags", "libraries", "date"})
        EXPECT_TRUE(here.contains(field)) << field;
    EXPECT_EQ(here["libraries"]["Eigen"], "3.4.0");
    EXPECT_NE(machine_line(here).find("cores"), std::string::npos);
}

TEST(Timing, Median) {
    EXPECT_EQ(median({3, 1, 2}), 2);
    EXPECT_EQ(median({4, 1, 2, 3}), 2.5);
    EXPECT_EQ(median({7}), 7);
    EXPECT_TRUE(std::isnan(median({})));
}

TEST(Timing, CountsThisThreadOnly) {
    double sum = 0;
    const double seconds = seconds_of([&] {
        for (int k = 1; k < 2000000; ++k) sum += 1.0 / k;
    });
    EXPECT_GT(seconds, 0);
    EXPECT_GT(sum, 1);
    int calls = 0;
    (void)median_seconds(3, [&] { ++calls; });
    EXPECT_EQ(calls, 3);
}

}  // namespace
}  // namespace tact::bench
