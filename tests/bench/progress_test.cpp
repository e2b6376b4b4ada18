#include "../../bench/harness/progress.hpp"

#include <gtest/gtest.h>

#include <csignal>
#include <sstream>

#include "../../bench/harness/interrupt.hpp"

namespace tact::bench {
namespace {

TEST(Progress, PlainLinesWhereThereIsNoTerminal) {
    std::ostringstream out;
    {
        Progress progress("march", 4, {.out = &out, .terminal = false, .quiet = 0, .every = 0});
        progress.at(1);
        progress.add(1);
    }
    EXPECT_EQ(out.str(), "march: 25 %, 0 s left\nmarch: 50 %, 0 s left\nmarch: 0 s\n");
}

TEST(Progress, ABarOnATerminal) {
    std::ostringstream out;
    {
        Progress progress("march", 2, {.out = &out, .terminal = true, .quiet = 0, .every = 0});
        progress.at(1);
    }
    EXPECT_NE(out.str().find("\r\033[K[###############...............] 50 %  march  0 s left"), std::string::npos)
        << out.str();
    EXPECT_TRUE(out.str().ends_with("\r\033[Kmarch: 0 s\n")) << out.str();
}

TEST(Progress, ShortStepsStayQuiet) {
    std::ostringstream out;
    { Progress("blink", 1, {.out = &out, .terminal = false}).at(1); }
    EXPECT_EQ(out.str(), "");
}

TEST(Progress, Durations) {
    EXPECT_EQ(duration(0.4), "0 s");
    EXPECT_EQ(duration(59), "59 s");
    EXPECT_EQ(duration(125), "2 min 5 s");
    EXPECT_EQ(duration(-1), "0 s");
}

TEST(Interrupt, ASignalStopsTheNextStep) {
    EXPECT_EXIT(
        {
            catch_interrupts();
            Progress progress("march", 2);
            progress.at(1);
            std::raise(SIGTERM);
            try {
                progress.at(2);
            } catch (const Interrupted&) {
                const bool stops = stop_on_interrupt()(State(), StepReport()) == Flow::stop;
                std::_Exit(stops ? 130 : 1);
            }
            std::_Exit(1);
        },
        testing::ExitedWithCode(130), "");
}

}  // namespace
}  // namespace tact::bench
