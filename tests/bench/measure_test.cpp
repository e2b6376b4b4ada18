#include "../../bench/harness/measure.hpp"

#include <gtest/gtest.h>

#include <sstream>

#include "../../bench/peers/interior_point.hpp"
#include "../../contact/automatic.hpp"
#include "../../contact/strategies/klu_active_set.hpp"

namespace tact::bench {
namespace {

TEST(Measure, SpreadTakesTheMiddlesOfEqualParts) {
    EXPECT_EQ(spread(4, 400), (std::vector<long>{50, 150, 250, 350}));
    EXPECT_EQ(spread(8, 3), (std::vector<long>{0, 1, 2}));
    EXPECT_EQ(spread(1, 1), std::vector<long>{0});
}

class Sampled : public testing::Test {
protected:
    Sampled() {
        scene_.t_end = 0.5;
        const Scheme scheme = paper_scheme(scene_);
        const auto solver = std::make_shared<SampledContact>(std::make_shared<AutomaticContact>(),
                                                             std::vector<long>{0, 60, 99}, samples_);
        ContactWorkspace workspace(solver);
        summary_ = run("test", scene_.family->at(Eigen::Vector2d(0.5, 0.4)), scheme, workspace);
    }
    StudyScene scene_ = study_scene("dynamic-obstacle", 15);
    std::vector<SampledSolve> samples_;
    RunSummary summary_;
    std::ostringstream out_;
    ProgressStyle quiet_{.out = &out_, .terminal = false};
};

TEST_F(Sampled, StepsAreTakenFromTheMarch) {
    ASSERT_EQ(samples_.size(), 3u);
    EXPECT_FALSE(samples_[0].A.same_storage(samples_[1].A)) << "the first step is backward Euler";
    EXPECT_TRUE(samples_[1].A.same_storage(samples_[2].A));
    EXPECT_EQ(samples_[0].lambda.maxCoeff(), 0);
    EXPECT_GT(samples_[2].lambda.maxCoeff(), 0);
    EXPECT_LT(summary_.worst_kkt, 1e-10);
}

TEST_F(Sampled, OtherSolversGiveTheSameSolution) {
    std::vector<std::shared_ptr<const ContactSolver>> solvers{std::make_shared<KluActiveSet>()};
    if (interior_point()) solvers.push_back(interior_point());
    for (const auto& solver : solvers) {
        Progress progress("replay", 3, quiet_);
        const Replay replayed = replay(*solver, samples_, 2, progress);
        EXPECT_EQ(replayed.seconds.size(), 3u);
        EXPECT_EQ(replayed.not_converged, 0);
        EXPECT_LT(replayed.worst_difference, 1e-3);
        const SampledSolve& s = samples_[2];
        Vector u = s.u, lambda = s.lambda, u_exact = s.u, lambda_exact = s.lambda;
        EXPECT_EQ(solver->prepare(s.A, s.B)->solve(s.b, s.c, {u, lambda}).outcome, Outcome::converged);
        EXPECT_EQ(AutomaticContact().prepare(s.A, s.B)->solve(s.b, s.c, {u_exact, lambda_exact}).outcome,
                  Outcome::converged);
        EXPECT_LT((u - u_exact).norm(), 1e-4 * u_exact.norm());
        EXPECT_LT((lambda - lambda_exact).norm(), 5e-3 * lambda_exact.norm());
    }
}

TEST(InteriorPoint, SolvesRowsThatAreNoBounds) {
    if (!interior_point()) GTEST_SKIP() << "built without IPOPT";
    // Two masses and the gap between them: u2 - u1 >= -1 under forces (4, -4) with unit springs: both stop at +-.5.
    DenseMatrix B(1, 2);
    B << -1, 1;
    Vector u = Vector::Zero(2), lambda = Vector::Zero(1);
    const auto prepared = interior_point()->prepare(Matrix::identity(2), Matrix(B));
    const ContactReport report = prepared->solve(Eigen::Vector2d(4, -4), Vector::Constant(1, -1), {u, lambda});
    EXPECT_EQ(report.outcome, Outcome::converged);
    EXPECT_NEAR(u[0], 0.5, 1e-6);
    EXPECT_NEAR(u[1], -0.5, 1e-6);
    EXPECT_NEAR(lambda[0], 3.5, 1e-5);
}

}  // namespace
}  // namespace tact::bench
