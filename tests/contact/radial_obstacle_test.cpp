// Against the exact solution of an obstacle problem: what all of the static chain is worth.
#include "../../lib/scenes/radial_obstacle.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "../../contact/automatic.hpp"

namespace tact {
namespace {

struct Distance {
    double largest, mean_square;
};

Distance distance_from_exact(Index n) {
    const Scene scene = radial_obstacle(n);
    const ContactProblem& problem = scene.problem;
    Vector u = problem.u0, lambda = Vector::Zero(u.size());
    const auto report =
        AutomaticContact().prepare(problem.K, problem.B)->solve(problem.f.at(0), problem.c.at(0), {u, lambda});
    EXPECT_EQ(report.outcome, Outcome::converged);
    EXPECT_LE(report.kkt.largest(), 1e-12);
    for (Index node = 0; node < u.size(); ++node)
        u[node] -= radial_obstacle_exact(4 * scene.mesh.x(node) - 2, 4 * scene.mesh.y(node) - 2);
    return {u.lpNorm<Eigen::Infinity>(), std::sqrt(u.squaredNorm() / static_cast<double>(u.size()))};
}

TEST(RadialObstacle, TheExactSolutionMeetsTheBallWithOneSlope) {
    const double a = 0.697965148223374, h = 1e-6;
    EXPECT_NEAR(radial_obstacle_exact(a + 1e-13, 0), std::sqrt(1 - a * a), 1e-12);
    EXPECT_NEAR((radial_obstacle_exact(a + h, 0) - radial_obstacle_exact(a, 0)) / h, -a / std::sqrt(1 - a * a), 1e-5);
}

TEST(RadialObstacle, ConvergesToTheExactSolutionAtSecondOrder) {
    // The free boundary falls between nodes by chance, so single ratios scatter: the order over three halvings of h.
    const Distance coarse = distance_from_exact(24), fine = distance_from_exact(199);
    const double halvings = std::log2(200.0 / 25.0);
    EXPECT_GT(std::log2(coarse.mean_square / fine.mean_square) / halvings, 1.8);
    EXPECT_GT(std::log2(coarse.largest / fine.largest) / halvings, 1.7);
    EXPECT_LT(fine.largest, 2e-4);
    for (const Index n : {49, 99}) {
        const Distance d = distance_from_exact(n);
        EXPECT_LT(d.mean_square, coarse.mean_square * 2.5 * std::pow(25.0 / static_cast<double>(n + 1), 2));
    }
}

}  // namespace
}  // namespace tact
