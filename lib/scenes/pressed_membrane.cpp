#include "pressed_membrane.hpp"

#include <cmath>
#include <numbers>

#include "line_elements.hpp"
#include "membrane.hpp"

namespace tact {

Scene pressed_membrane(Index n, const PressedMembraneData& data) {
    const char* object = "PressedMembraneData";
    check_data(object, "radius", data.radius, data.radius > 0, "a positive number");
    check_data(object, "clearance", data.clearance, data.clearance >= 0, "zero or more");
    check_data(object, "travel", data.travel, data.travel > 0, "a positive number");
    check_data(object, "pressure", data.pressure, true, "a finite number");
    check_data(object, "duration", data.duration, data.duration > 0, "a positive number");

    Scene scene = membrane(n, Eigen::Vector2d(0.45, 0.4));  // for its mesh and its K
    const Mesh& mesh = scene.mesh;
    const Index nodes = mesh.nodes();
    DenseMatrix shape(nodes, 2), load(nodes, 1);
    for (Index k = 0; k < nodes; ++k) {
        const double dx = mesh.x(k) - 0.5, dy = mesh.y(k) - 0.5;
        shape(k, 0) = -data.clearance - (dx * dx + dy * dy) / (2 * data.radius);
        shape(k, 1) = data.travel;
    }
    load.setConstant(data.pressure * mesh.h() * mesh.h());
    const double duration = data.duration;
    ContactProblem& problem = scene.problem;
    problem.B = Matrix::diagonal(Vector::Constant(nodes, -1));
    problem.c = AffineVector(std::move(shape), [duration](double t, Side, VectorRef out) {
        out[0] = 1;
        out[1] = (1 - std::cos(2 * std::numbers::pi * t / duration)) / 2;
    });
    problem.f = AffineVector(std::move(load), [duration](double t, Side, VectorRef out) { out[0] = t / duration; });
    return scene;
}

}  // namespace tact
