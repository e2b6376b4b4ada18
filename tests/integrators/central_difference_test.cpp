#include "../../integrators/central_difference.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <random>

#include "../../contact/automatic.hpp"
#include "../../lib/scenes/bar.hpp"
#include "random_systems.hpp"

namespace tact {
namespace {

ContactWorkspace automatic() { return ContactWorkspace(std::make_shared<AutomaticContact>()); }

/// Dense, with a lumped mass and bounds on some unknowns: what the energy law is proven for.
ContactProblem lumped_system(std::mt19937_64& random) {
    ContactProblem p = testing::random_stiff_system(random);
    const Index n = p.size();
    p.M = Matrix::diagonal(p.M->main_diagonal());
    const Index m = (n + 1) / 2;
    std::vector<Eigen::Triplet<double>> entries;
    for (Index i = 0; i < m; ++i) entries.emplace_back(i, 2 * i, i % 2 == 0 ? 1.5 : -0.5);
    SparseMatrix B(m, n);
    B.setFromTriplets(entries.begin(), entries.end());
    p.B = Matrix(B);
    std::uniform_real_distribution<double> uniform;
    const Vector gap = Vector::NullaryExpr(m, [&] { return uniform(random) < 0.3 ? 0.0 : uniform(random); });
    p.c = Vector(p.B * p.u0 - gap);
    return p;
}

/// 2 / omega by the eigenvalues of the dense pair.
double exact_limit(const ContactProblem& p) {
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> pairs(p.K.to_dense(), p.M->to_dense(),
                                                                          Eigen::EigenvaluesOnly);
    return 2 / std::sqrt(pairs.eigenvalues().maxCoeff());
}

TEST(CentralDifference, TheLargestStepIsThatOfTheEigenvalues) {
    std::mt19937_64 random(4);
    for (int k = 0; k < 200; ++k) {
        const bool lumped = k % 2 == 0;
        const ContactProblem p = lumped ? lumped_system(random) : testing::random_stiff_system(random);
        auto workspace = automatic();
        const double limit = exact_limit(p);
        EXPECT_NEAR(CentralDifference::largest_step(p, workspace), limit, 1e-6 * limit) << k;
        EXPECT_NO_THROW((void)CentralDifference().start(p, {0.999 * limit, 1}, workspace)) << k;
        EXPECT_THROW((void)CentralDifference().start(p, {1.001 * limit, 1}, workspace), InputError) << k;
    }
    // Many unknowns, whose fastest modes lie close together: lumped 1 and, by Lanczos alone, consistent masses.
    for (const bool consistent : {false, true}) {
        ContactProblem p = bar_impact(200).problem;
        if (consistent) p.M = combine(1, *p.M, 1e-5, p.K);
        auto workspace = automatic();
        const double limit = exact_limit(p), found = CentralDifference::largest_step(p, workspace);
        EXPECT_LE(found, limit * (1 + 1e-9));
        EXPECT_GE(found, limit * (1 - 2e-4));
    }
}

TEST(CentralDifference, TheLeapfrogEnergyNeverGrowsWithALumpedMass) {
    // |u1 - u0|_M^2 / (2 h^2) + u0'K u1 / 2 from the positions alone, at every step; no penetration.
    std::mt19937_64 random(5);
    double most = 0;
    long impacts = 0;
    for (int k = 0; k < 2000; ++k) {
        const ContactProblem p = lumped_system(random);
        const double h = 0.95 * exact_limit(p);
        auto workspace = automatic();
        const auto run = CentralDifference().start(p, {h, 40}, workspace);
        Vector u0 = p.u0;
        double start = 0, before = 0;
        for (int n = 0; n < 40; ++n) {
            const StepReport report = run->advance();
            ASSERT_EQ(report.outcome, Outcome::converged);
            impacts += report.impact.has_value();
            EXPECT_LE(report.contact.kkt.penetration, 1e-14);
            const Vector u1 = run->state().u(), rate = (u1 - u0) / h;
            const double now = 0.5 * rate.dot(*p.M * rate) + 0.5 * u0.dot(p.K * u1);
            if (n == 0) start = now;
            if (n > 0) most = std::max(most, (now - before) / start);
            before = now;
            u0 = u1;
        }
    }
    EXPECT_LE(most, 1e-11);
    EXPECT_GT(impacts, 5000);
}

TEST(CentralDifference, NearTheLargestStepABarMeetsTheWallAndLeavesAlmostExactly) {
    // The exact motion, to the way of one step: the impact falls somewhere in its step, and near h = dx / c waves travel
    // without dispersion.
    const BarImpactData bar;
    for (const Index elements : {50, 200}) {
        const ContactProblem p = bar_impact(elements, bar).problem;
        auto workspace = automatic();
        const double h = 0.993 * CentralDifference::largest_step(p, workspace);
        const long steps = std::lround(std::ceil(1.5 / h));
        const auto march = integrate(CentralDifference(), p, {1.5 / static_cast<double>(steps), steps}, workspace);
        ASSERT_EQ(march.outcome, Outcome::converged);
        double error = 0;
        for (Index i = 0; i <= elements; ++i) {
            const double x = bar.length * static_cast<double>(i) / static_cast<double>(elements);
            error = std::max(error, std::abs(march.final_state.u()[i] - bar_impact_exact(bar, x, 1.5).u));
        }
        EXPECT_LE(error, std::abs(bar.velocity) * h);
    }
}

TEST(CentralDifference, RefusesWhatItCannotTake) {
    ContactProblem p = bar_impact(10).problem;
    auto workspace = automatic();
    EXPECT_THROW(CentralDifference(1.5), InputError);
    ContactProblem massless = p;
    Vector mass = p.M->main_diagonal();
    mass[0] = 0;
    massless.M = Matrix::diagonal(mass);
    EXPECT_THROW((void)CentralDifference().start(massless, {1e-6, 1}, workspace), InputError);
    ContactProblem first_order = p;
    first_order.D = first_order.M;
    first_order.M.reset();
    EXPECT_THROW((void)CentralDifference().start(first_order, {1e-6, 1}, workspace), InputError);
}

}  // namespace
}  // namespace tact
