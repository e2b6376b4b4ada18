#include "plates.hpp"

#include <array>
#include <cmath>
#include <string>

#include "../errors.hpp"

namespace tact {
namespace {

struct StencilPoint {
    Index dx, dy;
    double weight;
};
// In the order of the rows of a column. The centre's 20 gains one for each adjacent edge.
constexpr std::array<StencilPoint, 13> thirteen_points{{{0, -2, 1},
                                                        {-1, -1, 2},
                                                        {0, -1, -8},
                                                        {1, -1, 2},
                                                        {-2, 0, 1},
                                                        {-1, 0, -8},
                                                        {0, 0, 20},
                                                        {1, 0, -8},
                                                        {2, 0, 1},
                                                        {-1, 1, 2},
                                                        {0, 1, -8},
                                                        {1, 1, 2},
                                                        {0, 2, 1}}};

/// One plate after the other on the diagonal, times `scale`.
SparseMatrix biharmonic(Index n, Index plates, double scale) {
    const Index nodes = n * n;
    SparseMatrix K(plates * nodes, plates * nodes);
    K.reserve(Eigen::Matrix<long, Eigen::Dynamic, 1>::Constant(plates * nodes, 13));
    for (Index column = 0; column < plates * nodes; ++column) {
        const Index i = column % n, j = column % nodes / n;
        for (const auto& [dx, dy, weight] : thirteen_points) {
            if (i + dx < 0 || i + dx >= n || j + dy < 0 || j + dy >= n) continue;
            const int edges = dx == 0 && dy == 0 ? (i == 0) + (i + 1 == n) + (j == 0) + (j + 1 == n) : 0;
            K.insert(column + dx + n * dy, column) = scale * (weight + edges);
        }
    }
    K.makeCompressed();
    return K;
}

/// u_upper - u_lower, node by node.
SparseMatrix node_to_node(Index nodes) {
    SparseMatrix B(nodes, 2 * nodes);
    B.reserve(Eigen::Matrix<long, Eigen::Dynamic, 1>::Ones(2 * nodes));
    for (Index node = 0; node < nodes; ++node) {
        B.insert(node, node) = -1;
        B.insert(node, nodes + node) = 1;
    }
    B.makeCompressed();
    return B;
}

AffineVector blow_to_lower(const Mesh& mesh, const PlatesData& data) {
    const double area = mesh.h() * mesh.h();
    DenseMatrix mode = DenseMatrix::Zero(mesh.unknowns(), 1);
    for (Index node = 0; node < mesh.nodes(); ++node) {
        const double dx = mesh.x(node) - 0.3, dy = mesh.y(node) - 0.4;
        mode(node, 0) = data.pressure * area * std::exp(-100 * (dx * dx + dy * dy));
    }
    // A grid's t_n may differ from blow_at by rounding; the jump must fall on that step all the same.
    const double at = data.blow_at, rounding = 1e-12 * std::max(1.0, std::abs(at));
    const auto coefficient = [at, rounding](double t, Side side, VectorRef out) {
        const bool at_jump = std::abs(t - at) <= rounding;
        const bool on = at_jump ? side == Side::right : t > at;
        out[0] = on ? std::exp(-1e4 * (t - at) * (t - at)) : 0.0;
    };
    return {std::move(mode), coefficient, {at}};
}

void check(const char* field, double value, bool ok, const char* expected) {
    if (!std::isfinite(value) || !ok)
        throw InputError(std::string("PlatesData: ") + field + " is " + shown(value) + ", expected " + expected);
}

}  // namespace

Scene two_plates(Index n, const PlatesData& data) {
    check("stiffness", data.stiffness, data.stiffness > 0, "a positive number");
    check("mass", data.mass, data.mass > 0, "a positive number");
    check("gap", data.gap, data.gap >= 0, "zero or more");
    check("pressure", data.pressure, true, "a finite number");
    check("blow_at", data.blow_at, true, "a finite number");
    Scene scene;
    scene.mesh = Mesh::unit_square(n, {0, data.gap});
    const Mesh& mesh = scene.mesh;
    const double area = mesh.h() * mesh.h();
    ContactProblem& problem = scene.problem;
    problem.M = Matrix::diagonal(Vector::Constant(mesh.unknowns(), data.mass * area));
    problem.K = Matrix(biharmonic(n, 2, data.stiffness / area));  // stencil / h^4 times the cell area
    problem.B = Matrix(node_to_node(mesh.nodes()));
    problem.c = Vector(Vector::Constant(mesh.nodes(), -data.gap));
    problem.f = blow_to_lower(mesh, data);
    problem.u0 = Vector::Zero(mesh.unknowns());
    problem.v0 = Vector::Zero(mesh.unknowns());
    return scene;
}

}  // namespace tact
