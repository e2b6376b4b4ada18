// A first stretch of the generated programmes; tests/generated runs any number of them.
#include "generated.hpp"

#include <gtest/gtest.h>

namespace tact::laws {
namespace {

TEST(Generated, NoStrategyIsWrongAndTheChooserMissesNone) {
    const auto all = strategies();
    for (std::uint64_t seed = 1; seed <= 2000; ++seed) {
        const Generated g = Generator(seed).draw();
        for (const Strategy& strategy : all) {
            const Judged j = judge(g, strategy);
            EXPECT_NE(j.verdict, Verdict::wrong) << "seed " << seed << ", " << strategy.name << ": " << j.why;
            EXPECT_NE(j.verdict, Verdict::missed) << "seed " << seed << ", " << strategy.name << ": " << j.why;
        }
    }
}

/// Drawn from 10^5: each of these had a strategy wrong once, or the chooser without an answer: unknowns and rows of other
/// units, rows that meet in one point, pairs that nearly exclude each other, zero as the answer.
TEST(Generated, WhatOnceWentWrongIsRight) {
    const auto all = strategies();
    for (const std::uint64_t seed :
         {6069,  8864,  10750, 11697, 12871, 13234, 14087, 14536, 15837, 20623, 21476, 26371, 26405, 27195, 35637,
          41952, 43034, 45856, 46240, 48449, 51988, 57671, 59451, 60559, 66061, 67053, 76915, 79557, 84280, 95814}) {
        const Generated g = Generator(seed).draw();
        for (const Strategy& strategy : all) {
            const Judged j = judge(g, strategy);
            EXPECT_NE(j.verdict, Verdict::wrong) << "seed " << seed << ", " << strategy.name << ": " << j.why;
            EXPECT_NE(j.verdict, Verdict::missed) << "seed " << seed << ", " << strategy.name << ": " << j.why;
        }
    }
}

}  // namespace
}  // namespace tact::laws
