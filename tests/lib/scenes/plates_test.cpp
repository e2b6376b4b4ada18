#include "../../../lib/scenes/plates.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>

#include "../../../lib/errors.hpp"

namespace tact {
namespace {

TEST(Plates, DiagonalCountsTheEdges) {
    const Scene scene = two_plates(7);
    const double scale = PlatesData().stiffness * 64;
    const Vector diagonal = scene.problem.K.main_diagonal() / scale;
    EXPECT_NEAR(diagonal[0], 22, 1e-12);
    EXPECT_NEAR(diagonal[3], 21, 1e-12);
    EXPECT_NEAR(diagonal[8], 20, 1e-12);
    EXPECT_NEAR(diagonal[49 + 48], 22, 1e-12);
    EXPECT_NEAR(scene.problem.K.to_dense().row(49 + 24).sum(), 0, 1e-9);
}

TEST(Plates, IsSymmetricPositiveDefinite) {
    const ContactProblem problem = two_plates(6).problem;
    validate(problem);
    EXPECT_TRUE(problem.K.is_symmetric(0));
    const DenseMatrix K = problem.K.to_dense();
    EXPECT_EQ(Eigen::LLT<DenseMatrix>(K).info(), Eigen::Success);
    EXPECT_EQ(K.topRightCorner(36, 36).cwiseAbs().maxCoeff(), 0) << "the plates are coupled only by contact";
    EXPECT_EQ(K.topLeftCorner(36, 36), K.bottomRightCorner(36, 36));
}

TEST(Plates, BiharmonicIsExactForQuartics) {
    const Scene scene = two_plates(11);
    const Mesh& mesh = scene.mesh;
    Vector u(mesh.unknowns());
    for (Index k = 0; k < mesh.nodes(); ++k) {
        const double x = mesh.x(k), y = mesh.y(k);
        u[k] = std::pow(x, 4) + 3 * x * x * y * y - 2 * std::pow(y, 4) + x * x * x * y;  // lap lap = 24 + 24 - 48 = 0
        u[mesh.nodes() + k] = x * x * y * y + std::pow(x, 4);                            // lap lap = 8 + 24
    }
    const double area = mesh.h() * mesh.h();
    const Vector Ku = scene.problem.K * u;
    for (Index j = 2; j < 9; ++j)
        for (Index i = 2; i < 9; ++i) {
            EXPECT_NEAR(Ku[i + 11 * j], 0, 1e-9);
            EXPECT_NEAR(Ku[mesh.nodes() + i + 11 * j], PlatesData().stiffness * area * 32, 1e-9);
        }
}

TEST(Plates, DeflectsAsAClampedSquarePlate) {
    // Uniform pressure q: centre deflection 0.00126532 q L^4 / D (Timoshenko and Woinowsky-Krieger, table 35).
    const Scene scene = two_plates(31);
    const Index nodes = scene.mesh.nodes();
    const double area = scene.mesh.h() * scene.mesh.h(), q = 50;
    const DenseMatrix K = scene.problem.K.to_dense().topLeftCorner(nodes, nodes);
    const Vector u = Eigen::LLT<DenseMatrix>(K).solve(Vector::Constant(nodes, q * area));
    EXPECT_NEAR(u[nodes / 2] * PlatesData().stiffness / q, 0.00126532, 0.01 * 0.00126532);
}

TEST(Plates, AreOfSteelOneMillimetreThick) {
    const double E = 200e9, h = 1e-3, nu = 0.3;
    EXPECT_NEAR(PlatesData().stiffness, E * h * h * h / (12 * (1 - nu * nu)), 1e-14 * PlatesData().stiffness);
}

TEST(Plates, MassAndGapArePhysical) {
    const Scene scene = two_plates(20);
    const ContactProblem& problem = scene.problem;
    const double covered = std::pow(20.0 / 21, 2);  // the cells of the interior nodes
    EXPECT_NEAR(problem.M->main_diagonal().sum(), 2 * 7.8 * covered, 1e-12);
    // Lower plate up by .03 and upper plate down by .015: five millimetres too far.
    Vector u(800);
    u << Vector::Constant(400, 0.03), Vector::Constant(400, -0.015);
    const Vector gap = problem.B * u - problem.c.at(0);
    EXPECT_NEAR(gap.maxCoeff(), -0.005, 1e-15);
    EXPECT_NEAR(gap.minCoeff(), -0.005, 1e-15);
    EXPECT_EQ(scene.mesh.bodies[1].first, 400);
    EXPECT_EQ(scene.mesh.bodies[1].elevation, 0.04);
    EXPECT_EQ(two_plates(5, {.gap = 0.03}).problem.c.at(0)[0], -0.03);
}

TEST(Plates, BlowStartsAtItsJumpAndOnTheLowerPlate) {
    const Scene scene = two_plates(9);
    const AffineVector& f = scene.problem.f;
    ASSERT_EQ(f.jumps.size(), 1u);
    EXPECT_DOUBLE_EQ(f.jumps[0], 0.002);
    EXPECT_EQ(f.at(9 * 2e-4).cwiseAbs().maxCoeff(), 0);
    EXPECT_EQ(f.at(10 * 2e-4, Side::left).cwiseAbs().maxCoeff(), 0);
    const Vector full = f.at(10 * 2e-4);
    EXPECT_EQ(full.tail(81).cwiseAbs().maxCoeff(), 0);
    const Index node = 2 + 9 * 3;  // (.3, .4)
    EXPECT_NEAR(full[node], 1e5 * 0.01, 1e-10);
    EXPECT_NEAR(full[node + 1], 1e3 * std::exp(-1.0), 1e-10);
    EXPECT_NEAR(f.at(0.012)[node], 1e3 * std::exp(-1.0), 1e-10);
    EXPECT_NEAR(f.at(0.012, Side::left)[node], 1e3 * std::exp(-1.0), 1e-10);
}

TEST(Plates, RejectsBadInput) {
    EXPECT_THROW(two_plates(2), InputError);
    EXPECT_THROW(two_plates(5, {.stiffness = 0}), InputError);
    EXPECT_THROW(two_plates(5, {.mass = -1}), InputError);
    EXPECT_THROW(two_plates(5, {.gap = -0.01}), InputError);
    EXPECT_THROW(two_plates(5, {.pressure = std::nan("")}), InputError);
}

}  // namespace
}  // namespace tact
