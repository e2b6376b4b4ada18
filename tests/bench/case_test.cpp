#include "../../bench/commands/case.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "../../bench/harness/scenes.hpp"
#include "../../contact/automatic.hpp"
#include "../../lib/errors.hpp"

namespace tact::bench {
namespace {

TEST(Case, StaticObstacle) {
    const Json json =
        run_case({.scene = "static-obstacle", .n = 20, .gamma = {0.45, 0.4}, .points = {{0.5, 0.5}, {0, 0.3}}});
    EXPECT_EQ(json["outcome"], "converged");
    EXPECT_EQ(json["unknowns"], 400);
    EXPECT_FALSE(json.contains("dt"));
    EXPECT_LT(json["kkt"]["largest"], 1e-10);
    const Json& state = json["states"].at(0);
    EXPECT_GT(state["active"], 0);
    EXPECT_NEAR(state["points"][0]["u"], -0.66, 0.05);
    EXPECT_EQ(state["points"][1]["u"], 0);
    EXPECT_LT(state["energy"]["total"], -1.6);
}

TEST(Case, DynamicObstacleInTheOrderAskedFor) {
    const Json json =
        run_case({.scene = "dynamic-obstacle", .n = 16, .gamma = {0.6, 0.6}, .t_end = 0.5, .at = {0.5, 0, 0.25}});
    EXPECT_EQ(json["integrator"], "bdf2");
    EXPECT_EQ(json["steps"], 100);
    ASSERT_EQ(json["states"].size(), 3u);
    EXPECT_EQ(json["states"][0]["step"], 100);
    EXPECT_EQ(json["states"][1]["energy"]["total"], 0);
    EXPECT_EQ(json["states"][2]["step"], 50);
    EXPECT_GT(json["first_contact_step"], 40);
    EXPECT_LT(json["kkt"]["largest"], 1e-10);
}

TEST(Case, TwoPlatesReportsBothFromTheirOwnRest) {
    const Json json =
        run_case({.scene = "two-plates", .n = 10, .t_end = 0.02, .at = {0.002, 0.02}, .points = {{0.3, 0.4}}});
    const Json& first = json["states"][0]["points"][0];
    EXPECT_GT(first["lower"], 0);
    EXPECT_EQ(first["upper"], 0);
    EXPECT_GT(json["first_contact_step"], 10);
    EXPECT_GT(json["states"][1]["max_u"], 0);
}

TEST(Case, BarsOnTheLineAreComparedWithTheirExactMotion) {
    const Json json =
        run_case({.scene = "two-bars", .n = 50, .at = {0.2, 2}, .points = {{-10, std::nan("")}, {0, std::nan("")}}});
    EXPECT_EQ(json["outcome"], "converged");
    EXPECT_EQ(json["n"], 50);
    EXPECT_EQ(json["unknowns"], 102);
    const Json& points = json["states"][0]["points"];
    ASSERT_EQ(points.size(), 3u) << "both bars have a point at 0";
    EXPECT_NEAR(points[0]["u"], 2, 1e-10);
    EXPECT_EQ(points[2]["body"], 1);
    EXPECT_LT(json["states"][0]["error"]["u"], 1e-10);
    EXPECT_LT(json["states"][1]["error"]["u"], 0.2);
    EXPECT_NEAR(json["impulse"], 100, 2) << "the left bar's momentum";
    EXPECT_GE(json["contact_intervals"], 1);
    EXPECT_THROW(run_case({.scene = "two-bars", .points = {{0, 0}}}), InputError);
    EXPECT_THROW(run_case({.scene = "two-bars", .points = {{11, std::nan("")}}}), InputError);
    EXPECT_THROW(run_case({.scene = "two-plates", .n = 5, .points = {{0.5, std::nan("")}}}), InputError);
}

TEST(Case, AStaticSceneIsComparedToo) {
    const Json error = run_case({.scene = "draped-string-at-rest", .n = 100})["states"][0]["error"];
    EXPECT_LT(error["u"], 1e-4);
    EXPECT_EQ(error["v"], 0);
    EXPECT_NEAR(error["contact_force"], 0, 1e-9);
}

TEST(Case, ASlowLoadHasEquilibriaAtTheTimesAskedFor) {
    const Json json = run_case({.scene = "pressed-membrane", .n = 20, .at = {0, 0.5}});
    EXPECT_EQ(json["outcome"], "converged");
    ASSERT_EQ(json["states"].size(), 2u);
    EXPECT_EQ(json["states"][0]["active"], 0);
    EXPECT_GT(json["states"][1]["active"], 0);
    EXPECT_EQ(json["states"][1]["t"], 0.5);
    const Json march = run_case({.scene = "pressed-membrane", .n = 20, .dt = 0.05, .t_end = 0.5});
    EXPECT_EQ(march["integrator"], "quasi-static");
    EXPECT_EQ(march["states"][0]["active"], json["states"][1]["active"]);
    EXPECT_NEAR(march["states"][0]["contact_force"], json["states"][1]["contact_force"], 1e-9);
    EXPECT_THROW(run_case({.scene = "draped-string-at-rest", .at = {0.5}}), InputError);
}

TEST(Case, EverySceneOfTheListRuns) {
    for (const std::string& name : study_scene_names()) {
        StudyScene scene = study_scene(name, 12);
        CaseOptions options{.scene = name, .n = 12, .gamma = std::vector<double>(scene.family->names().size(), 0.4)};
        if (!scene.is_static()) options.t_end = 20 * scene.dt;
        EXPECT_EQ(run_case(options)["outcome"], "converged") << name;
    }
}

/// Gives up at its seventh solve.
class GivesUp final : public ContactSolver {
public:
    std::unique_ptr<PreparedContact> prepare(const Matrix& A, const Matrix& B) const override {
        struct Prepared final : PreparedContact {
            Prepared(std::unique_ptr<PreparedContact> solver, int& count) : inner(std::move(solver)), solves(count) {}
            ContactReport solve(const ConstVectorRef& b, const ConstVectorRef& c, ContactPoint point) override {
                if (++solves < 7) return inner->solve(b, c, point);
                ContactReport report;
                report.outcome = Outcome::iteration_limit;
                return report;
            }
            std::unique_ptr<PreparedContact> inner;
            int& solves;
        };
        return std::make_unique<Prepared>(AutomaticContact().prepare(A, B), *solves_);
    }

private:
    std::shared_ptr<int> solves_ = std::make_shared<int>(0);
};

TEST(Case, SaysWhichStepDidNotConverge) {
    const Json json =
        run_case({.scene = "two-plates", .n = 6, .at = {0.0004, 0.4}, .contact = std::make_shared<GivesUp>()});
    EXPECT_EQ(json["outcome"], "iteration limit");
    EXPECT_EQ(json["failed_step"], 7);
    EXPECT_EQ(json["accepted_steps"], 6);
    EXPECT_EQ(json["message"], "step 7: the contact solve ended with iteration limit");
    EXPECT_EQ(json["states"].size(), 1u) << "what was reached is there";
}

TEST(Case, RejectsBadInput) {
    EXPECT_THROW(run_case({.scene = "three-plates"}), InputError);
    EXPECT_THROW(run_case({.scene = "two-plates", .n = 2}), InputError);
    EXPECT_THROW(run_case({.scene = "two-plates", .n = -4}), InputError);
    EXPECT_THROW(run_case({.scene = "two-plates", .n = 5, .gamma = {0.3}}), InputError);
    EXPECT_THROW(run_case({.scene = "dynamic-obstacle", .n = 5}), InputError);
    EXPECT_THROW(run_case({.scene = "static-obstacle", .n = 5, .gamma = {0.3, 0.3}, .dt = 0.1}), InputError);
    const CaseOptions good{.scene = "dynamic-obstacle", .n = 5, .gamma = {0.3, 0.3}, .t_end = 0.02};
    const auto with = [&](auto change) {
        CaseOptions options = good;
        change(options);
        return options;
    };
    EXPECT_NO_THROW(run_case(good));
    EXPECT_THROW(run_case(with([](CaseOptions& o) { o.dt = 0; })), InputError);
    EXPECT_THROW(run_case(with([](CaseOptions& o) { o.dt = -0.005; })), InputError);
    EXPECT_THROW(run_case(with([](CaseOptions& o) { o.dt = 0.003; })), InputError);
    EXPECT_THROW(run_case(with([](CaseOptions& o) { o.at = {0.0075}; })), InputError);
    EXPECT_THROW(run_case(with([](CaseOptions& o) { o.at = {0.025}; })), InputError);
    EXPECT_THROW(run_case(with([](CaseOptions& o) { o.points = {{0.5, 1.5}}; })), InputError);
    EXPECT_THROW(run_case(with([](CaseOptions& o) { o.integrator = "rk4"; })), InputError);
}

TEST(Case, ParsesPoints) {
    using Points = std::vector<std::array<double, 2>>;
    EXPECT_EQ(parse_points(""), Points());
    EXPECT_EQ(parse_points(".5,.25"), (Points{{0.5, 0.25}}));
    EXPECT_EQ(parse_points("0.5,1e-2;1,0;"), (Points{{0.5, 0.01}, {1, 0}}));
    const Points line = parse_points(".5;-3");
    ASSERT_EQ(line.size(), 2u);
    EXPECT_EQ(line[1][0], -3);
    EXPECT_TRUE(std::isnan(line[0][1]) && std::isnan(line[1][1]));
    for (const char* bad : {".5,", ".5,.3,.1", "a,b", ".5 .3", ",;"})
        EXPECT_THROW(parse_points(bad), InputError) << bad;
}

}  // namespace
}  // namespace tact::bench
