#include "string.hpp"

#include <cmath>

namespace tact {
namespace {

void check(const PluckedStringData& data) {
    const char* object = "PluckedStringData";
    check_data(object, "length", data.length, data.length > 0, "a positive number");
    check_data(object, "tension", data.tension, data.tension > 0, "a positive number");
    check_data(object, "density", data.density, data.density > 0, "a positive number");
    check_data(object, "height", data.height, data.height >= 0, "zero or more");
    check_data(object, "pluck", data.pluck, data.pluck > 0 && data.pluck < 1, "between 0 and 1");
    check_data(object, "obstacle", data.obstacle, data.obstacle > 0 && data.obstacle < 1, "between 0 and 1");
}

/// The bouncing bar's unit of time, in which a wave runs from the middle to an end.
double half_crossing(const PluckedStringData& data) {
    check(data);
    const char* expected = "1/2: the exact motion is known at the middle";
    check_data("PluckedStringData", "pluck", data.pluck, data.pluck == 0.5, expected);
    check_data("PluckedStringData", "obstacle", data.obstacle, data.obstacle == 0.5, expected);
    return data.length / 2 * std::sqrt(data.density / data.tension);
}

void check(const DrapedStringData& data) {
    const char* object = "DrapedStringData";
    check_data(object, "length", data.length, data.length > 0, "a positive number");
    check_data(object, "tension", data.tension, data.tension > 0, "a positive number");
    check_data(object, "density", data.density, data.density > 0, "a positive number");
    check_data(object, "gravity", data.gravity, data.gravity > 0, "a positive number");
    check_data(object, "curvature", data.curvature, data.curvature > 0, "a positive number");
    check_data(object, "height", data.height, data.height >= 0, "zero or more");
    check_data(object, "damping", data.damping, data.damping >= 0, "zero or more");
}

}  // namespace

Scene plucked_string(Index elements, const PluckedStringData& data, Mass mass) {
    check(data);
    check_elements("plucked_string", elements, 2);
    const double at = data.obstacle * static_cast<double>(elements);
    check_data("plucked_string", "obstacle times elements", at, std::abs(at - std::round(at)) < 1e-9,
               "a whole number: a node");
    Scene scene;
    scene.mesh.add_line(0, data.length, elements, Mesh::Ends::fixed);
    const Index n = elements - 1;
    const auto inner = [n](const SparseMatrix& A) { return SparseMatrix(A.block(1, 1, n, n)); };
    ContactProblem& problem = scene.problem;
    problem.M = mass_matrix(inner(line_mass(elements, data.length, data.density, mass)), mass);
    problem.K = Matrix(inner(line_stiffness(elements, data.length, data.tension)));
    problem.B = Matrix(single_row(n, {{std::lround(at) - 1, 1}}));
    problem.c = Vector(Vector::Zero(1));
    problem.f = Vector(Vector::Zero(n));
    const auto s = scene.mesh.bodies[0].line.array() / data.length;
    problem.u0 = data.height * (s / data.pluck).min((1 - s) / (1 - data.pluck));
    problem.v0 = Vector::Zero(n);
    return scene;
}

BarState plucked_string_exact(const PluckedStringData& data, double x, double t) {
    const double unit = half_crossing(data), half = data.length / 2;
    const BarState bar = bouncing_bar_exact(std::abs(x - half) / half, t / unit);
    const double scale = 2 * data.height, slope = (x < half ? -1 : 1) * data.tension / half;
    return {scale * bar.u, scale / unit * bar.v, scale * slope * bar.stress};
}

double plucked_string_force(const PluckedStringData& data, double t) {
    return 8 * data.tension * data.height / data.length * bouncing_bar_force(t / half_crossing(data));
}

Scene draped_string(Index elements, const DrapedStringData& data, Motion motion) {
    check(data);
    check_elements("draped_string", elements);
    Scene scene;
    scene.mesh.add_line(-data.length / 2, data.length / 2, elements);
    const Index n = elements + 1;
    const Vector cells = line_mass(elements, data.length, 1, Mass::lumped).diagonal();
    ContactProblem& problem = scene.problem;
    if (motion == Motion::dynamic) {
        problem.M = Matrix::diagonal(data.density * cells);
        if (data.damping > 0) problem.D = Matrix::diagonal(data.damping * cells);
        problem.v0 = Vector::Zero(n);
    }
    problem.K = Matrix(line_stiffness(elements, data.length, data.tension));
    problem.B = Matrix::identity(n);
    problem.c = Vector(-data.curvature / 2 * scene.mesh.bodies[0].line.array().square());
    problem.f = Vector(-data.density * data.gravity * cells);
    problem.u0 = Vector::Constant(n, data.height);
    return scene;
}

double draped_string_rest(const DrapedStringData& data, double x) {
    check(data);
    const double q = data.density * data.gravity;
    const double s = data.length / 2 * q / (q + data.tension * data.curvature);
    const double beyond = std::abs(x) - s;
    if (beyond <= 0) return -data.curvature * x * x / 2;
    return -data.curvature * s * (s / 2 + beyond) + q * beyond * beyond / (2 * data.tension);
}

}  // namespace tact
