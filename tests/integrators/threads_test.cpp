// Runs share nothing but immutable recipes and matrices: two threads, each with its own workspace, do not see each other.
#include <gtest/gtest.h>

#include <thread>

#include "../../contact/automatic.hpp"
#include "every_integrator.hpp"
#include "thrown_plates.hpp"

namespace tact {
namespace {

struct Answer {
    Outcome outcome = Outcome::stopped;
    Vector y, lambda;
};

Answer answer(const Integrator& method, const ContactProblem& problem, const TimeGrid& grid) {
    ContactWorkspace workspace(std::make_shared<AutomaticContact>());
    const auto march = integrate(method, problem, grid, workspace);
    return {march.outcome, march.final_state.y, march.final_state.lambda};
}

void expect_same(const Answer& a, const Answer& b, const std::string& name) {
    EXPECT_EQ(a.outcome, b.outcome) << name;
    EXPECT_EQ(a.y, b.y) << name;
    EXPECT_EQ(a.lambda, b.lambda) << name;
}

TEST(Threads, TwoRunsAtOnceAreTheTwoRunsOneAfterTheOther) {
    // One problem, whose matrices both share, and one integrator; different numbers of steps.
    const ContactProblem problem = testing::thrown_plates(8);
    const TimeGrid grids[] = {{2e-4, 150}, {2e-4, 111}};
    for (const auto& [name, method] : testing::every_integrator()) {
        Answer in_turn[2], at_once[2];
        for (int k = 0; k < 2; ++k) in_turn[k] = answer(*method, problem, grids[k]);
        EXPECT_EQ(in_turn[0].outcome, Outcome::converged) << name;
        // Their own copies, whose storage is shared: what a problem finds out about its matrices it finds out in both.
        const ContactProblem fresh = testing::thrown_plates(8);
        std::thread other([&, m = method.get()] { at_once[1] = answer(*m, fresh, grids[1]); });
        at_once[0] = answer(*method, fresh, grids[0]);
        other.join();
        for (int k = 0; k < 2; ++k) expect_same(at_once[k], in_turn[k], name);
    }
}

}  // namespace
}  // namespace tact
