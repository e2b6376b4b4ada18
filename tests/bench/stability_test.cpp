#include "../../bench/studies/stability/stability.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "../../bench/studies/stability/stability_row.hpp"
#include "../../lib/errors.hpp"
#include "../../lib/scenes/mass_on_stop.hpp"

namespace tact::bench {
namespace {

StabilityCase thrown_mass() {
    StabilityCase c{.group = "test", .name = "thrown mass"};
    c.problem = mass_on_stop({.gravity = 0, .velocity = -1}).problem;
    c.grid = {0.1, 30};
    c.exact = [](double t, double e) { return std::isnan(e) ? Vector() : Vector(Vector::Constant(1, e * (t - 1))); };
    return c;
}

TEST(Stability, JudgesAMarchAgainstTheExactRebound) {
    const Json row = stability_row(thrown_mass(), "trapezoid:e=0.5", 10);
    EXPECT_EQ(row["judgement"], "right");
    EXPECT_EQ(row["outcome"], "converged");
    EXPECT_EQ(row["steps"], 30);
    EXPECT_EQ(row["penetration_max"], 0);
    EXPECT_NEAR(row["energy_ratio_max"], 1, 1e-12);
    EXPECT_LT(row["kkt_residual_max"], 1e-14);
    EXPECT_LE(row["error"], 0.05 + 1e-12) << "half a step at the speed of the rebound";
    StabilityCase narrow = thrown_mass();
    narrow.problem.u0[0] = 1.03;  // the step ends .07 past the impact
    narrow.error_limit = 1e-6;
    EXPECT_EQ(stability_row(narrow, "trapezoid:e=0.5", 10)["judgement"], "wrong");
}

TEST(Stability, SeesTheEnergyThatBdf2GainsInASingleImpact) {
    // Its restitution is above one in some phases.
    double most = 0;
    int gains = 0;
    for (int phase = 0; phase < 10; ++phase) {
        StabilityCase c = thrown_mass();
        c.problem.u0[0] = 1 + 0.01 * phase;
        const Json row = stability_row(c, "bdf2", 10);
        EXPECT_TRUE(row["error"].is_null());
        gains += row["judgement"] == "gains energy";
        most = std::max(most, row["energy_ratio_max"].get<double>());
    }
    EXPECT_GT(gains, 0);
    EXPECT_LT(gains, 10);
    EXPECT_NEAR(most, 1.5, 0.1);
}

TEST(Stability, TellsRejectionFailureAndPenetrationApart) {
    StabilityCase inside = thrown_mass();
    inside.problem.u0[0] = -1;
    EXPECT_EQ(stability_row(inside, "bdf2", 10)["judgement"], "honest failure");
    EXPECT_EQ(stability_row(inside, "bdf2", 10)["outcome"], "rejected");
    inside.rejected = true;
    EXPECT_EQ(stability_row(inside, "bdf2", 10)["judgement"], "right");
    StabilityCase missed = thrown_mass();
    missed.rejected = true;
    EXPECT_EQ(stability_row(missed, "bdf2", 10)["judgement"], "wrong");
    StabilityCase beside = thrown_mass();
    beside.problem.u0[0] = 1.03;
    EXPECT_EQ(stability_row(beside, "moreau-jean", 10)["judgement"], "penetrates");
    StabilityCase hopeless = thrown_mass();
    hopeless.problem.c = AffineVector(DenseMatrix(DenseMatrix::Ones(1, 1)),
                                      [](double, Side, VectorRef) { throw NumericalError("no gap today"); });
    const Json failed = stability_row(hopeless, "trapezoid", 10);
    EXPECT_EQ(failed["judgement"], "honest failure");
    EXPECT_EQ(failed["message"], "no gap today");
}

TEST(Stability, AnEndlessCaseCostsItsLimitAndNoMore) {
    StabilityCase endless = thrown_mass();
    endless.grid.steps = 4'000'000'000;
    const Json row = stability_row(endless, "bdf2", 1);
    EXPECT_EQ(row["judgement"], "out of time");
    EXPECT_EQ(row["outcome"], "out of time");
}

TEST(Stability, EveryIntegratorIsAskedAndItsRestitutionKnown) {
    const std::vector<std::string> names = stability_integrators();
    EXPECT_GE(names.size(), 20u);
    EXPECT_EQ(restitution_of("trapezoid"), 0);
    EXPECT_EQ(restitution_of("trapezoid:rho=0.3,e=0.25"), 0.25);
    EXPECT_EQ(restitution_of("moreau-jean:e=1"), 1);
    EXPECT_EQ(restitution_of("ida:e=0"), 0);
    EXPECT_TRUE(std::isnan(restitution_of("sdirk2:rtol=1e-4")));
    EXPECT_TRUE(std::isnan(restitution_of("bdf2")));
    for (const StabilityCase& c : stability_cases(true)) {
        int asked = 0;
        for (const std::string& name : names) asked += applies(c, name);
        EXPECT_GT(asked, 0) << c.name;
        EXPECT_NO_THROW(validate(c.problem)) << c.name;
    }
}

TEST(Stability, TheStudyOfTwoGroupsHasRowsTableAndPage) {
    const Json json = run_stability(
        {.small = true, .groups = {"gap", "equilibrium"}, .integrators = {"trapezoid", "quasi-static"}});
    for (const Json& row : json["rows"]) {
        for (const char* field :
             {"case", "integrator", "outcome", "energy_ratio_max", "penetration_max", "kkt_residual_max", "error"})
            EXPECT_TRUE(row.contains(field)) << field;
        EXPECT_TRUE(row["judgement"] == "right" || row["judgement"] == "honest failure") << row;
    }
    EXPECT_NE(stability_table(json).find("trapezoid"), std::string::npos);
    EXPECT_NE(stability_markdown(json).find("*honest failure*"), std::string::npos);
    EXPECT_THROW(run_stability({.small = true, .groups = {"weather"}}), InputError);
    EXPECT_THROW(run_stability({.small = true, .integrators = {"leapfrog"}}), InputError);
}

}  // namespace
}  // namespace tact::bench
