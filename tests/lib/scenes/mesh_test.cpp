#include "../../../lib/scenes/mesh.hpp"

#include <gtest/gtest.h>

#include "../../../lib/errors.hpp"

namespace tact {
namespace {

TEST(Mesh, NumbersBodyAfterBody) {
    const Mesh mesh = Mesh::unit_square(4, {0, 0.25});
    EXPECT_EQ(mesh.unknowns(), 32);
    EXPECT_EQ(mesh.bodies[1].first, 16);
    EXPECT_EQ(mesh.bodies[1].elevation, 0.25);
    EXPECT_DOUBLE_EQ(mesh.x(6), 3 / 5.0);
    EXPECT_DOUBLE_EQ(mesh.y(6), 2 / 5.0);
}

TEST(Mesh, BilinearValuesAreExactForAProduct) {
    const Mesh mesh = Mesh::unit_square(9, {0, 1});
    Vector u(mesh.unknowns());
    for (Index node = 0; node < mesh.nodes(); ++node) {
        u[node] = 3 + mesh.x(node) - 2 * mesh.y(node) + mesh.x(node) * mesh.y(node);
        u[mesh.nodes() + node] = -u[node];
    }
    const auto exact = [](double x, double y) { return 3 + x - 2 * y + x * y; };
    for (const auto& [x, y] : {std::pair{0.5, 0.5}, {0.123, 0.777}, {0.1, 0.1}, {0.9, 0.3}}) {
        EXPECT_NEAR(value_at(mesh, u, x, y), exact(x, y), 1e-14);
        EXPECT_NEAR(value_at(mesh, u, x, y, 1), -exact(x, y), 1e-14);
    }
}

TEST(Mesh, ValueFallsToZeroOnTheBoundary) {
    const Mesh mesh = Mesh::unit_square(3);
    const Vector u = Vector::Ones(9);
    EXPECT_EQ(value_at(mesh, u, 0, 0.4), 0);
    EXPECT_EQ(value_at(mesh, u, 1, 1), 0);
    EXPECT_EQ(value_at(mesh, u, 0.3, 1), 0);
    EXPECT_DOUBLE_EQ(value_at(mesh, u, 0.125, 0.5), 0.5);
    EXPECT_DOUBLE_EQ(value_at(mesh, u, 0.125, 0.875), 0.25);
}

TEST(Mesh, LinesHaveTheirOwnNodesAndEnds) {
    Mesh mesh = Mesh::on_line();
    mesh.add_line(-2, 0, 4);
    mesh.add_line(0, 1, 5, Mesh::Ends::right_fixed);
    mesh.add_line(1, 3, 4, Mesh::Ends::fixed);
    mesh.add_line(7, 7, 0);
    EXPECT_EQ(mesh.unknowns(), 5 + 5 + 3 + 1);
    EXPECT_EQ(mesh.bodies[2].first, 10);
    EXPECT_EQ(mesh.bodies[0].line, (Vector(5) << -2, -1.5, -1, -0.5, 0).finished());
    EXPECT_EQ(mesh.bodies[2].line, (Vector(3) << 1.5, 2, 2.5).finished());
    Vector u(14);
    for (const Mesh::Body& body : mesh.bodies) u.segment(body.first, body.line.size()) = 3 + body.line.array();
    EXPECT_DOUBLE_EQ(value_on_line(mesh, u, -1.3, 0), 1.7);
    EXPECT_EQ(value_on_line(mesh, u, -2, 0), 1);
    EXPECT_EQ(value_on_line(mesh, u, 0, 0), 3);
    EXPECT_EQ(value_on_line(mesh, u, 0, 1), 3);
    EXPECT_DOUBLE_EQ(value_on_line(mesh, u, 0.9, 1), 1.9) << "half way between 3.8 and 0";
    EXPECT_EQ(value_on_line(mesh, u, 1, 2), 0);
    EXPECT_DOUBLE_EQ(value_on_line(mesh, u, 1.25, 2), 2.25);
    EXPECT_EQ(value_on_line(mesh, u, 3, 2), 0);
    EXPECT_EQ(value_on_line(mesh, u, 7, 3), 10);
}

TEST(Mesh, LinesRejectBadInput) {
    Mesh mesh = Mesh::on_line();
    EXPECT_THROW(mesh.add_line(1, 0, 3), InputError);
    EXPECT_THROW(mesh.add_line(0, 1, 0), InputError);
    EXPECT_THROW(mesh.add_line(0, 0, 1), InputError);
    EXPECT_THROW(mesh.add_line(0, 1, -2), InputError);
    EXPECT_THROW(mesh.add_line(0, 1, 1, Mesh::Ends::fixed), InputError);
    EXPECT_THROW(mesh.add_line(0, std::nan(""), 1), InputError);
    mesh.add_line(0, 1, 2);
    EXPECT_THROW(value_on_line(mesh, Vector::Zero(3), 1.1), InputError);
    EXPECT_THROW(value_on_line(mesh, Vector::Zero(3), 0.5, 1), InputError);
    EXPECT_THROW(value_on_line(mesh, Vector::Zero(4), 0.5), InputError);
    EXPECT_THROW(value_at(mesh, Vector::Zero(3), 0.5, 0.5), InputError);
    Mesh square = Mesh::unit_square(3);
    EXPECT_THROW(square.add_line(0, 1, 2), InputError);
    EXPECT_THROW(value_on_line(square, Vector::Zero(9), 0.5), InputError);
}

TEST(Mesh, RejectsBadInput) {
    EXPECT_THROW(Mesh::unit_square(2), InputError);
    EXPECT_THROW(Mesh::unit_square(5, {}), InputError);
    const Mesh mesh = Mesh::unit_square(3);
    EXPECT_THROW(value_at(mesh, Vector::Zero(8), 0.5, 0.5), InputError);
    EXPECT_THROW(value_at(mesh, Vector::Zero(9), 0.5, 1.01), InputError);
    EXPECT_THROW(value_at(mesh, Vector::Zero(9), std::nan(""), 0.5), InputError);
    EXPECT_THROW(value_at(mesh, Vector::Zero(9), 0.5, 0.5, 1), InputError);
}

}  // namespace
}  // namespace tact
