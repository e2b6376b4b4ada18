// A first stretch of the generated programmes; tests/generated runs any number of them.
#include "tact/tests/laws/generated.hpp"

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

}  // namespace
}  // namespace tact::laws
