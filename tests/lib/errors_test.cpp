#include "../../lib/errors.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <limits>

namespace tact {
namespace {

TEST(Shown, AreTheFewestDigitsThatReadBackAsTheSameNumber) {
    EXPECT_EQ(shown(1e-7), "1e-07");
    EXPECT_EQ(shown(0.1), "0.1");
    EXPECT_EQ(shown(-3), "-3");
    EXPECT_EQ(shown(0), "0");
    EXPECT_EQ(shown(std::numeric_limits<double>::infinity()), "inf");
    EXPECT_EQ(shown(-std::numeric_limits<double>::infinity()), "-inf");
    EXPECT_EQ(shown(std::nan("")), "nan");
    for (const double x :
         {1.0 / 3, 5.551115123125783e-17, -1.7976931348623157e308, 4.9e-324, 2.2250738585072014e-308})
        EXPECT_EQ(std::strtod(shown(x).c_str(), nullptr), x) << shown(x);
}

}  // namespace
}  // namespace tact
