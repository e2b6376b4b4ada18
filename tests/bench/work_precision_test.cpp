#include "../../bench/studies/work_precision/work_precision.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "../../bench/harness/scenes.hpp"
#include "../../bench/peers/peer_program.hpp"
#include "../../bench/peers/siconos_peer.hpp"
#include "../../bench/studies/work_precision/work_precision_answers.hpp"
#include "../../bench/studies/work_precision/work_precision_gsl.hpp"
#include "../../bench/studies/work_precision/work_precision_run.hpp"
#include "../../contact/dense/dense_contact.hpp"
#include "../../integrators/sundials/bdf2.hpp"
#include "../../lib/errors.hpp"

namespace tact::bench {
namespace {

const PrecisionMethod& method(const std::string& label) {
    const auto found =
        std::ranges::find_if(precision_methods(), [&](const auto& each) { return each.label() == label; });
    EXPECT_NE(found, precision_methods().end()) << label;
    return *found;
}

TEST(WorkPrecision, GslAndTheModesAgreeOnTheFreeMembrane) {
    const PrecisionScene scene = precision_scene("free-membrane", true);
    const auto exact = scene.reference(method("bdf2"));
    std::vector<double> times;
    for (long k = 1; k <= scene.outputs; ++k) times.push_back(scene.output(k));
    for (const auto& [name, bound] : {std::pair{"rk8pd", 1e-7}, {"msadams", 1e-4}, {"msbdf", 1e-2}}) {
        const OrdinaryRun run =
            solve_ordinary(name, ordinary(scene.problem, std::string(name) == "msbdf"), times, 1e-8, 1e-11, 10);
        ASSERT_EQ(run.failure, "") << name;
        EXPECT_LT(error_u(scene, run.y.topRows(scene.problem.size()), *exact), bound) << name;
        EXPECT_GT(run.steps, 10);
    }
}

TEST(WorkPrecision, SecondOrderOnTheHeldBarAgainstGsl) {
    const PrecisionScene scene = precision_scene("held-bar", true);
    for (const PrecisionMethod& each : precision_methods_for(scene)) {
        if (each.adaptive) continue;
        const auto reference = scene.reference(each);
        EXPECT_LT(reference->own_error_u, 1e-8);
        const double coarse = error_u(scene, record(each, 640, scene, Ledgers::none).u, *reference);
        const double fine = error_u(scene, record(each, 1280, scene, Ledgers::none).u, *reference);
        EXPECT_GT(std::log2(coarse / fine), 0.8) << each.label() << " " << coarse << " " << fine;
        EXPECT_LT(fine, 1e-2) << each.label();
    }
}

TEST(WorkPrecision, TheImpulseOfTheBarIsThatOfTheExactForce) {
    const PrecisionScene scene = precision_scene("bar-impact", true);
    const auto exact = scene.reference(method("trapezoid"));
    EXPECT_NEAR(exact->impulse[scene.outputs - 1], 200, 1e-9) << "2 rho L |v0|";
    const Recorded recorded = record(method("trapezoid"), 960, scene, Ledgers::kept);
    ASSERT_EQ(recorded.outcome, Outcome::converged);
    EXPECT_EQ(recorded.steps, 960);
    EXPECT_LT(error_lambda(recorded.impulse, *exact), 0.05);
    EXPECT_LE(recorded.energy_drift, 1e-12) << "the energy theorem";
}

TEST(WorkPrecision, SiconosMarchesAsOurMoreauJeanDoes) {
    const auto program = siconos_program();
    if (!program) GTEST_SKIP() << "built without Siconos";
    EXPECT_NE(peer_version(*program).find('.'), std::string::npos);
    const PrecisionMethod& ours = method("moreau-jean");
    for (const char* name : {"bar-impact", "two-plates-coarse"}) {
        PrecisionScene scene = precision_scene(name, true);
        scene.problem.f = Vector(scene.problem.f.at(0.003));  // where a load jumps, a step takes another share of it
        scene.steps.resize(2);
        int done = 0;
        const std::vector<Json> rows = siconos_rows(scene, *program, 5, [&] { ++done; });
        EXPECT_EQ(done, 2);
        ASSERT_EQ(rows.size(), 2u);
        for (std::size_t k = 0; k < rows.size(); ++k) {
            const auto steps = static_cast<double>(scene.steps[k]);
            const Json expected = precision_row(scene, ours, steps, {.repeats = 1, .enough = 0, .limit = 10});
            ASSERT_EQ(rows[k]["outcome"], "converged") << rows[k];
            EXPECT_GT(rows[k]["seconds"], 0);
            for (const char* field : {"error_u", "error_lambda"})
                EXPECT_NEAR(rows[k][field].get<double>() / expected[field].get<double>(), 1, 1e-6) << rows[k];
        }
    }
}

TEST(WorkPrecision, SiconosLeavesOutWhatWouldTakeTooLong) {
    const auto program = siconos_program();
    if (!program) GTEST_SKIP() << "built without Siconos";
    PrecisionScene scene = precision_scene("bar-impact", true);
    scene.steps = {30, 3000000};
    const std::vector<Json> rows = siconos_rows(scene, *program, 2, [] {});
    EXPECT_EQ(rows[0]["outcome"], "converged");
    EXPECT_NE(rows[1]["outcome"].get<std::string>().find("would take"), std::string::npos);
    EXPECT_TRUE(rows[1]["error_u"].is_null());
    scene.problem.D = scene.problem.K;
    EXPECT_THROW(siconos_rows(scene, *program, 2, [] {}), InputError);
}

TEST(WorkPrecision, AFailureIsARowThatSaysWhy) {
    const PrecisionScene scene = precision_scene("bar-impact", true);
    const Json row = precision_row(scene, method("bdf2"), 15360, {.repeats = 1, .enough = 0, .limit = 1e-4});
    EXPECT_EQ(row["outcome"], "not done in 0.0001 s");
    EXPECT_TRUE(row["seconds"].is_null());
    EXPECT_TRUE(row["error_u"].is_null());
}

TEST(WorkPrecision, RowsHaveTheirFields) {
    const Json json = run_work_precision({.small = true, .repeats = 1, .scenes = {"bouncing-bar"}, .answers = false});
    std::size_t expected = 0;
    const PrecisionScene scene = precision_scene("bouncing-bar", true);
    for (const PrecisionMethod& each : precision_methods())
        expected += each.adaptive ? scene.tolerances.size() : scene.steps.size();
    ASSERT_EQ(json["rows"].size(), expected);
    for (const Json& row : json["rows"])
        for (const char* field : {"scene", "integrator", "parameter", "steps", "seconds", "error_u", "error_lambda",
                                  "energy_drift", "restitution_min", "restitution_max", "outcome"})
            EXPECT_TRUE(row.contains(field)) << field;
    EXPECT_NE(work_precision_table(json).find("trapezoid"), std::string::npos);
    EXPECT_NE(work_precision_markdown(json).find("## bouncing-bar"), std::string::npos);
}

TEST(WorkPrecision, TheHandWrittenLoopIsBdf2OnMassesAgainstStops) {
    ContactProblem problem;
    problem.M = Matrix::identity(3);
    problem.K = Matrix::diagonal(Eigen::Vector3d(1, 4, 25));
    problem.B = Matrix(DenseMatrix(DenseMatrix::Ones(1, 3)));
    problem.c = Vector(Vector::Constant(1, -0.2));
    problem.f = Vector(Eigen::Vector3d(-1, 0.5, -2));
    problem.u0 = problem.v0 = Vector::Zero(3);
    const TimeGrid grid = TimeGrid::until(1, 0.01);
    ContactWorkspace workspace(std::make_shared<DenseContact>());
    const MarchReport march = integrate(Bdf2(), problem, grid, workspace);
    ASSERT_GT(march.first_contact_step, 0);
    EXPECT_LT((hand_written_bdf2(problem, grid, workspace) - march.final_state.u()).norm(), 1e-11);
}

TEST(WorkPrecision, RejectsBadInput) {
    EXPECT_THROW(run_work_precision({.small = true, .repeats = 0}), InputError);
    EXPECT_THROW(run_work_precision({.small = true, .scenes = {"plates"}}), InputError);
    EXPECT_THROW(ordinary(study_scene("bar-impact", 4).family->at({}), false), InputError);
    EXPECT_THROW(solve_ordinary("euler", {}, {1}, 1e-3, 1e-6, 1), InputError);
}

}  // namespace
}  // namespace tact::bench
