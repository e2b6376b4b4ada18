#include "../../../lib/scenes/membrane.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <array>
#include <cmath>
#include <numbers>

#include "../../../lib/errors.hpp"

namespace tact {
namespace {

double obstacle(double x, double y, double gamma1, double gamma2) {
    return -1 + 0.4 * std::exp(-200 * (std::pow(x - gamma1, 2) + std::pow(y - 0.5, 2))) +
           gamma2 * std::exp(-355.56 * (std::pow(x - 0.7, 2) + std::pow(y - 0.5, 2)));
}

TEST(Membrane, GapIsEquation19) {
    const MembraneFamily family(50);
    const Parameter gamma = Eigen::Vector2d(0.4321, 0.277);
    const Vector c = family.at(gamma).c.at(0);
    for (Index node = 0; node < c.size(); ++node)
        EXPECT_NEAR(c[node], obstacle(family.mesh().x(node), family.mesh().y(node), 0.4321, 0.277), 1e-14);
    // Rows of any order and number, more than one block of the vectorised loop included.
    std::vector<Index> rows;
    for (Index k = 0; k < 333; ++k) rows.push_back((k * 977) % c.size());
    Vector out(333);
    family.gap(gamma, rows, out);
    for (Index k = 0; k < out.size(); ++k) EXPECT_DOUBLE_EQ(out[k], c[rows[static_cast<std::size_t>(k)]]);
}

TEST(Membrane, FiveRowsOfTheStencil) {
    const ContactProblem problem = membrane(6, Eigen::Vector2d(0.5, 0.5)).problem;
    const DenseMatrix K = problem.K.to_dense();
    EXPECT_EQ(K.diagonal().minCoeff(), 4);
    EXPECT_EQ(K.diagonal().maxCoeff(), 4);
    const Vector sums = K.rowwise().sum();
    EXPECT_EQ(sums[0], 2);
    EXPECT_EQ(sums[1], 1);
    EXPECT_EQ(sums[7], 0);
    EXPECT_TRUE(problem.K.is_symmetric(0));
    EXPECT_EQ(Eigen::LLT<DenseMatrix>(K).info(), Eigen::Success);
    validate(problem);
}

TEST(Membrane, StencilHasTheLaplacianEigenvectors) {
    const MembraneFamily family(15);
    const Mesh& mesh = family.mesh();
    Vector mode(mesh.nodes());
    for (Index k = 0; k < mode.size(); ++k)
        mode[k] = std::sin(2 * std::numbers::pi * mesh.x(k)) * std::sin(3 * std::numbers::pi * mesh.y(k));
    const double eigenvalue =
        4 - 2 * std::cos(2 * std::numbers::pi * mesh.h()) - 2 * std::cos(3 * std::numbers::pi * mesh.h());
    const Vector residual = family.at(Eigen::Vector2d(0.4, 0.4)).K * mode - eigenvalue * mode;
    EXPECT_LT(residual.cwiseAbs().maxCoeff(), 1e-13);
}

TEST(Membrane, IsExactForAQuadraticProduct) {
    // u = x (1 - x) y (1 - y) vanishes at the edges: -lap u = 2 (x (1 - x) + y (1 - y)), without discretisation error.
    const MembraneFamily family(21);
    const Mesh& mesh = family.mesh();
    Vector u(mesh.nodes()), minus_laplacian(mesh.nodes());
    for (Index k = 0; k < u.size(); ++k) {
        const double x = mesh.x(k), y = mesh.y(k);
        u[k] = x * (1 - x) * y * (1 - y);
        minus_laplacian[k] = 2 * (x * (1 - x) + y * (1 - y));
    }
    const ContactProblem problem = family.at(Eigen::Vector2d(0.3, 0.2));
    const double area = mesh.h() * mesh.h();
    EXPECT_LT((problem.K * u - area * minus_laplacian).cwiseAbs().maxCoeff(), 1e-15);
    EXPECT_DOUBLE_EQ(problem.f.at(0).minCoeff(), -10 * area);
}

TEST(Membrane, FamilySharesWhatDoesNotDependOnGamma) {
    const MembraneFamily family(8, Motion::dynamic);
    const ContactProblem a = family.at(Eigen::Vector2d(0.3, 0.2)), b = family.at(Eigen::Vector2d(0.6, 0.6));
    EXPECT_TRUE(a.K.same_storage(b.K));
    EXPECT_TRUE(a.B.same_storage(b.B));
    ASSERT_TRUE(a.M.has_value());
    EXPECT_TRUE(a.M->same_storage(*b.M));
    EXPECT_DOUBLE_EQ(a.M->main_diagonal()[5], 1.0 / 81);
    EXPECT_TRUE(a.second_order());
    validate(a);
    EXPECT_TRUE(MembraneFamily(8).at(Eigen::Vector2d(0.3, 0.2)).is_static());
}

TEST(Membrane, RejectsBadInput) {
    EXPECT_THROW(MembraneFamily(2), InputError);
    EXPECT_THROW(MembraneFamily(-1), InputError);
    const MembraneFamily family(4);
    EXPECT_THROW(family.at(Parameter::Zero(3)), InputError);
    EXPECT_THROW(family.at(Eigen::Vector2d(0.3, std::nan(""))), InputError);
    Vector out(1);
    EXPECT_THROW(family.gap(Eigen::Vector2d(0.3, 0.3), std::array<Index, 1>{16}, out), InputError);
    EXPECT_THROW(family.gap(Eigen::Vector2d(0.3, 0.3), std::array<Index, 1>{-1}, out), InputError);
    EXPECT_THROW(family.gap(Eigen::Vector2d(0.3, 0.3), std::array<Index, 2>{1, 2}, out), InputError);
}

}  // namespace
}  // namespace tact
