#include "../../bench/studies/solvers/solvers.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <stdexcept>

#include "../../bench/harness/contact_solvers.hpp"
#include "../../bench/harness/growth.hpp"
#include "../../bench/harness/isolated.hpp"
#include "../../bench/harness/timing.hpp"
#include "../../bench/peers/interior_point.hpp"
#include "../../bench/peers/peer_program.hpp"
#include "../../bench/peers/petsc_peer.hpp"
#include "../../bench/studies/solvers/solver_timing.hpp"

namespace tact::bench {
namespace {

TEST(Isolated, ReturnsTheValueAndWhatItsMemoryGrewBy) {
    const Json json = isolated(
        [] {
            std::vector<double> block(std::size_t{4} << 20, 1.0);
            return Json{{"sum", block.front() + block.back()}, {"long", std::string(200000, 'x')}};
        },
        10);
    EXPECT_EQ(json["sum"], 2);
    EXPECT_EQ(json["long"].get<std::string>().size(), 200000u) << "more than a pipe holds at once";
    EXPECT_GT(json["peak_bytes"].get<double>(), 30e6);
    EXPECT_LT(json["peak_bytes"].get<double>(), 60e6);
}

TEST(Isolated, SaysWhyThereIsNoValue) {
    EXPECT_EQ(isolated([]() -> Json { throw std::runtime_error("no factor"); }, 10)["error"], "no factor");
    const Json crashed = isolated([]() -> Json { std::abort(); }, 10);
    EXPECT_NE(crashed["error"].get<std::string>().find("signal"), std::string::npos) << crashed;
    const Json endless = isolated(
        []() -> Json {
            for (double sum = 1;; sum += cpu_seconds())
                if (sum < 0) return sum;
        },
        1);
    EXPECT_NE(endless["error"].get<std::string>().find("out of time"), std::string::npos) << endless;
}

TEST(Isolated, ProgramsEndWithTheirCode) {
    EXPECT_EQ(run_program({"/bin/true"}, 5), "");
    EXPECT_NE(run_program({"/bin/false"}, 5), "");
    EXPECT_NE(run_program({"/absent/program"}, 5), "");
}

TEST(Growth, FitsTheExponent) {
    const std::vector<double> x{10, 100, 1000}, y{3, 3 * std::pow(10, 1.3), 3 * std::pow(100, 1.3)};
    EXPECT_NEAR(fitted_exponent(x, y).get<double>(), 1.3, 1e-12);
    EXPECT_TRUE(fitted_exponent({10}, {1}).is_null());
    EXPECT_TRUE(fitted_exponent({10, 10}, {1, 2}).is_null());
}

TEST(SolverProblems, TheOtherNumberingHasTheSameSolution) {
    for (const SolverProblem& problem : solver_problems("two-plates", 6, 0.01)) {
        const SolverProblem other = permuted(problem);
        ASSERT_EQ(problem.samples.size(), problem.weights.size());
        EXPECT_LT(problem.reference_agreement, 1e-9);
        for (std::size_t k = 0; k < problem.samples.size(); ++k) {
            const SampledSolve &a = problem.samples[k], &b = other.samples[k];
            EXPECT_NEAR(a.b.dot(a.solution), b.b.dot(b.solution), 1e-12 * std::abs(a.b.dot(a.solution)));
            EXPECT_NEAR((a.A * a.solution).norm(), (b.A * b.solution).norm(), 1e-9 * (a.A * a.solution).norm());
            EXPECT_NEAR((a.B * a.solution - a.c).norm(), (b.B * b.solution - b.c).norm(), 1e-12);
            EXPECT_GT((a.A.to_sparse() - b.A.to_sparse()).norm(), 0) << "it is another numbering";
            EXPECT_TRUE(b.A.same_storage(other.samples[0].A));
        }
    }
}

TEST(SolverProblems, WeightsMakeTheMeanOfTheMarch) {
    const std::vector<SolverProblem> problems = solver_problems("dynamic-obstacle", 12, 0.6);
    ASSERT_EQ(problems.size(), 2u);
    double sum = 0;
    for (const double weight : problems[1].weights) sum += weight;
    EXPECT_NEAR(sum, 1, 1e-12);
    EXPECT_EQ(problems[0].weights, (std::vector<double>{0, 1}));
}

TEST(Solvers, RowsHaveTheFieldsAndTheSolversAgree) {
    const Json json = run_solvers({.small = true,
                                   .repeats = 2,
                                   .peers = true,
                                   .scenes = {"static-obstacle", "dynamic-obstacle"},
                                   .side = 20,
                                   .growth = {{8, 12}, {6}}});
    ASSERT_EQ(json["problems"].size(), 4u);
    EXPECT_EQ(json["problems"][0]["problem"], "static, cold");
    int choosers = 0, peers = 0;
    for (const Json& row : json["rows"]) {
        for (const char* field : {"problem", "solver", "seconds_median", "seconds_min", "iterations", "kkt_residual",
                                  "solution_error", "peer"})
            EXPECT_TRUE(row.contains(field)) << field;
        peers += row["peer"].get<bool>();
        if (row["solver"] != "chooser") continue;
        ++choosers;
        EXPECT_LT(row["kkt_residual"], 1e-10);
        EXPECT_LT(row["solution_error"], 1e-8);
        EXPECT_GT(row["seconds_min"], 0);
        EXPECT_LE(row["seconds_min"], row["seconds_median"]);
    }
    EXPECT_EQ(choosers, 4);
    EXPECT_EQ(peers > 0, interior_point() || petsc_program());
    ASSERT_EQ(json["numbering"].size(), 4u);
    EXPECT_GT(json["numbering"][0]["ratio"], 0);
    ASSERT_EQ(json["growth"].size(), 1u);
    ASSERT_EQ(json["growth"][0]["points"].size(), 2u);
    EXPECT_EQ(json["growth"][0]["points"][1]["unknowns"], 144);
    EXPECT_GT(json["growth"][0]["points"][1]["contact_steps"], 0);
    EXPECT_NE(solvers_table(json).find("chooser"), std::string::npos);
    EXPECT_NE(solvers_markdown(json).find("| static, cold"), std::string::npos);
}

TEST(Solvers, PetscAgreesWhereItIsThere) {
    const auto program = petsc_program();
    if (!program) GTEST_SKIP() << "built without PETSc";
    EXPECT_NE(peer_version(*program).find('.'), std::string::npos);
    for (const SolverProblem& problem : solver_problems("two-plates", 8, 0.01))
        for (const PetscMethod& method : petsc_methods()) {
            const Json row = time_petsc(problem, method, *program, {.repeats = 2});
            EXPECT_FALSE(row.contains("message")) << row;
            if (row["outcome"] != "converged") continue;
            EXPECT_LT(row["solution_error"], 1e-4) << row;
            EXPECT_LT(row["kkt_residual"], 1e-3) << row;
        }
}

TEST(Solvers, SaysWhichPeersAreMissing) {
    EXPECT_EQ(missing_peers(Json{{"peers", {{"IPOPT", "3.14"}, {"PETSc", "3.18"}}}}), "");
    EXPECT_NE(missing_peers(Json{{"peers", {{"IPOPT", "3.14"}, {"PETSc", nullptr}}}}).find("PETSc"),
              std::string::npos);
}

TEST(Solvers, RejectsBadInput) {
    EXPECT_THROW(run_solvers({.small = true, .repeats = 0}), InputError);
    EXPECT_THROW(run_solvers({.small = true, .scenes = {"plates"}}), InputError);
}

}  // namespace
}  // namespace tact::bench
