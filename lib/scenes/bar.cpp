#include "bar.hpp"

#include <algorithm>
#include <cmath>

#include "../errors.hpp"

namespace tact {
namespace {

void check(const BarImpactData& data) {
    const char* object = "BarImpactData";
    check_data(object, "length", data.length, data.length > 0, "a positive number");
    check_data(object, "density", data.density, data.density > 0, "a positive number");
    check_data(object, "modulus", data.modulus, data.modulus > 0, "a positive number");
    check_data(object, "velocity", data.velocity, true, "a finite number");
    check_data(object, "gap", data.gap, data.gap >= 0, "zero or more");
    check_data(object, "gravity", data.gravity, true, "a finite number");
}

void check_exact(const BarImpactData& data) {
    check(data);
    check_data("BarImpactData", "velocity", data.velocity, data.velocity < 0, "a negative number: towards the wall");
    check_data("BarImpactData", "gravity", data.gravity, data.gravity == 0, "zero: the exact motion knows none");
}

void check(const TwoBarsData& data) {
    for (const auto& [object, bar] : {std::pair{"TwoBarsData.left", data.left}, {"TwoBarsData.right", data.right}}) {
        check_elements(object, bar.elements);
        check_data(object, "length", bar.length, bar.length > 0, "a positive number");
        check_data(object, "density", bar.density, bar.density > 0, "a positive number");
        check_data(object, "modulus", bar.modulus, bar.modulus > 0, "a positive number");
        check_data(object, "velocity", bar.velocity, true, "a finite number");
    }
    check_data("TwoBarsData", "gap", data.gap, data.gap >= 0, "zero or more");
}

double travel_time(const Bar& bar) { return bar.length * std::sqrt(bar.density / bar.modulus); }
double impedance(const Bar& bar) { return std::sqrt(bar.modulus * bar.density); }

void check_exact(const TwoBarsData& data) {
    check(data);
    check_data("TwoBarsData", "left.velocity - right.velocity", data.left.velocity - data.right.velocity,
               data.left.velocity > data.right.velocity, "a positive number: the bars meet");
    const double ratio = travel_time(data.left) / travel_time(data.right);
    check_data("TwoBarsData", "the ratio of travel times", ratio, std::abs(ratio - 1) <= 1e-12, "one");
}

SparseMatrix block_diagonal(const SparseMatrix& A, const SparseMatrix& B) {
    std::vector<Eigen::Triplet<double, long>> entries;
    const auto append = [&entries](const SparseMatrix& S, long offset) {
        for (Index column = 0; column < S.outerSize(); ++column)
            for (SparseMatrix::InnerIterator it(S, column); it; ++it)
                entries.emplace_back(it.row() + offset, it.col() + offset, it.value());
    };
    append(A, 0);
    append(B, A.rows());
    SparseMatrix both(A.rows() + B.rows(), A.cols() + B.cols());
    both.setFromTriplets(entries.begin(), entries.end());
    return both;
}

/// A bar that meets a wall at its end x = 0 with `speed`, touching at t = 0, in the wall's frame.
BarState meet_wall(double length, double wave_speed, double modulus, double speed, double x, double t) {
    const double stop = x / wave_speed, leave = (2 * length - x) / wave_speed;
    if (t <= stop) return {-speed * t, -speed, 0};
    if (t <= leave) return {-speed * stop, 0, -modulus * speed / wave_speed};
    return {speed * (t - 2 * length / wave_speed), speed, 0};
}

}  // namespace

Scene bar_impact(Index elements, const BarImpactData& data, Mass mass) {
    check(data);
    check_elements("bar_impact", elements);
    Scene scene;
    scene.mesh.add_line(0, data.length, elements);
    const Index n = elements + 1;
    ContactProblem& problem = scene.problem;
    const SparseMatrix M = line_mass(elements, data.length, data.density, mass);
    problem.f = Vector(-data.gravity * (M * Vector::Ones(n)));
    problem.M = mass_matrix(M, mass);
    problem.K = Matrix(line_stiffness(elements, data.length, data.modulus));
    problem.B = Matrix(single_row(n, {{0, 1}}));
    problem.c = Vector(Vector::Zero(1));
    problem.u0 = Vector::Constant(n, data.gap);
    problem.v0 = Vector::Constant(n, data.velocity);
    return scene;
}

BarState bar_impact_exact(const BarImpactData& data, double x, double t) {
    check_exact(data);
    const double speed = -data.velocity;
    return meet_wall(data.length, std::sqrt(data.modulus / data.density), data.modulus, speed, x,
                     t - data.gap / speed);
}

double bar_impact_force(const BarImpactData& data, double t) {
    check_exact(data);
    const double s = t + data.gap / data.velocity;
    const bool touching = s > 0 && s < 2 * data.length * std::sqrt(data.density / data.modulus);
    return touching ? -data.velocity * std::sqrt(data.modulus * data.density) : 0;
}

Scene bouncing_bar(Index elements, Mass mass) {
    check_elements("bouncing_bar", elements);
    Scene scene;
    scene.mesh.add_line(0, 1, elements, Mesh::Ends::right_fixed);
    ContactProblem& problem = scene.problem;
    problem.M = mass_matrix(line_mass(elements, 1, 1, mass).topLeftCorner(elements, elements), mass);
    problem.K = Matrix(SparseMatrix(line_stiffness(elements, 1, 1).topLeftCorner(elements, elements)));
    problem.B = Matrix(single_row(elements, {{0, 1}}));
    problem.c = Vector(Vector::Zero(1));
    problem.f = Vector(Vector::Zero(elements));
    problem.u0 = (1 - scene.mesh.bodies[0].line.array()) / 2;
    problem.v0 = Vector::Zero(elements);
    return scene;
}

BarState bouncing_bar_exact(double x, double t) {
    const double s = t - 3 * std::floor(t / 3);
    if (s <= 1) return s <= x ? BarState{(1 - x) / 2, 0, -0.5} : BarState{(1 - s) / 2, -0.5, 0};
    if (s > 2) return s - 2 <= 1 - x ? BarState{(s - 2) / 2, 0.5, 0} : BarState{(1 - x) / 2, 0, -0.5};
    const double lowest = std::min({s - 1, 2 - s, x, 1 - x});
    if (lowest == s - 1) return {-lowest / 2, -0.5, 0};
    if (lowest == x) return {-lowest / 2, 0, -0.5};
    if (lowest == 1 - x) return {-lowest / 2, 0, 0.5};
    return {-lowest / 2, 0.5, 0};
}

double bouncing_bar_force(double t) {
    const double s = t - 3 * std::floor(t / 3);
    return s > 1 && s < 2 ? 0.5 : 0;
}

Scene two_bars(const TwoBarsData& data, Mass mass) {
    check(data);
    const Bar &left = data.left, &right = data.right;
    Scene scene;
    scene.mesh.add_line(-left.length, 0, left.elements);
    scene.mesh.add_line(0, right.length, right.elements);
    scene.mesh.bodies[1].elevation = data.gap;
    const Index first = scene.mesh.bodies[1].first, n = scene.mesh.unknowns();
    const auto both = [&](const auto& matrix_of) { return block_diagonal(matrix_of(left), matrix_of(right)); };
    ContactProblem& problem = scene.problem;
    problem.M =
        mass_matrix(both([mass](const Bar& b) { return line_mass(b.elements, b.length, b.density, mass); }), mass);
    problem.K = Matrix(both([](const Bar& b) { return line_stiffness(b.elements, b.length, b.modulus); }));
    problem.B = Matrix(single_row(n, {{first - 1, -1}, {first, 1}}));
    problem.c = Vector(Vector::Constant(1, -data.gap));
    problem.f = Vector(Vector::Zero(n));
    problem.u0 = Vector::Zero(n);
    problem.v0 = Vector::Constant(n, left.velocity);
    problem.v0.tail(n - first).setConstant(right.velocity);
    return scene;
}

BarState two_bars_exact(const TwoBarsData& data, double x, double t, std::size_t body) {
    check_exact(data);
    // In the frame of the interface each bar meets a wall with speed force/Z; the left one is its mirror image.
    const Bar& bar = body == 0 ? data.left : data.right;
    const double sign = body == 0 ? -1 : 1;
    const double meet = data.gap / (data.left.velocity - data.right.velocity);
    const double speed = two_bars_force(data, meet + travel_time(bar)) / impedance(bar);
    const double frame = bar.velocity + sign * speed;
    const BarState state =
        meet_wall(bar.length, std::sqrt(bar.modulus / bar.density), bar.modulus, speed, std::abs(x), t - meet);
    return {bar.velocity * meet + frame * (t - meet) + sign * state.u, frame + sign * state.v, state.stress};
}

double two_bars_force(const TwoBarsData& data, double t) {
    check_exact(data);
    const double speed = data.left.velocity - data.right.velocity, s = t - data.gap / speed;
    const double Z1 = impedance(data.left), Z2 = impedance(data.right);
    return s > 0 && s < 2 * travel_time(data.left) ? speed * Z1 * Z2 / (Z1 + Z2) : 0;
}

}  // namespace tact
