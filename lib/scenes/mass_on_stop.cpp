#include "mass_on_stop.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "line_elements.hpp"

namespace tact {
namespace {

void check(const MassOnStopData& data) {
    const char* object = "MassOnStopData";
    check_data(object, "mass", data.mass, data.mass > 0, "a positive number");
    check_data(object, "gravity", data.gravity, data.gravity >= 0, "zero or more");
    check_data(object, "stiffness", data.stiffness, data.stiffness >= 0, "zero or more");
    check_data(object, "height", data.height, data.height >= 0, "zero or more");
    check_data(object, "velocity", data.velocity, true, "a finite number");
}

/// u + sag = (u0 + sag) cos + v0/w sin, sag = g/w^2; its limit w -> 0 is u0 + v0 t - g t^2/2.
struct Flight {
    double gravity, frequency;

    BounceState at(double u0, double v0, double t) const {
        if (frequency == 0) return {u0 + t * (v0 - gravity * t / 2), v0 - gravity * t};
        const double sag = gravity / (frequency * frequency);
        const double c = std::cos(frequency * t), s = std::sin(frequency * t);
        // 1 - cos without cancellation: a weak spring must not spoil the parabola.
        const double half = std::sin(frequency * t / 2);
        return {u0 * c + v0 / frequency * s - 2 * sag * half * half, v0 * c - (u0 + sag) * frequency * s};
    }

    /// The time from height u0 >= 0 to the stop; infinite if it never falls.
    double duration(double u0, double v0) const {
        if (u0 == 0 && v0 <= 0) return 0;
        if (frequency == 0) {
            // u0 + v0 t = g t^2/2, as a quotient without cancellation.
            const double root = std::sqrt(v0 * v0 + 2 * gravity * u0);
            if (v0 < 0) return 2 * u0 / (root - v0);
            return gravity > 0 ? (v0 + root) / gravity : infinity;
        }
        // From the stop and back, with its own limit for a spring without gravity.
        if (u0 == 0) return 2 / frequency * std::atan2(v0 * frequency, gravity);
        const double sag = gravity / (frequency * frequency);
        const double a = u0 + sag, b = v0 / frequency;
        return (std::atan2(b, a) + std::acos(std::min(1.0, sag / std::hypot(a, b)))) / frequency;
    }
};

}  // namespace

Scene mass_on_stop(const MassOnStopData& data) {
    check(data);
    Scene scene;
    scene.mesh.add_line(0, 0, 0);
    ContactProblem& problem = scene.problem;
    problem.M = Matrix::diagonal(Vector::Constant(1, data.mass));
    problem.K = Matrix::diagonal(Vector::Constant(1, data.stiffness));
    problem.B = Matrix(single_row(1, {{0, 1}}));
    problem.c = Vector(Vector::Zero(1));
    problem.f = Vector(Vector::Constant(1, -data.mass * data.gravity));
    problem.u0 = Vector::Constant(1, data.height);
    problem.v0 = Vector::Constant(1, data.velocity);
    return scene;
}

BounceState bouncing_ball(const MassOnStopData& data, double restitution, double t) {
    check(data);
    check_data("bouncing_ball", "restitution", restitution, restitution >= 0 && restitution <= 1, "from 0 to 1");
    check_data("bouncing_ball", "t", t, t >= 0, "zero or more");
    const Flight flight{data.gravity, std::sqrt(data.stiffness / data.mass)};
    double begin = 0, u0 = data.height, v0 = data.velocity;
    double impulse = 0;
    for (long impacts = 0;; ++impacts) {
        const double end = begin + flight.duration(u0, v0);
        // Flights too short to move the clock: past the accumulation of impacts, where it rests.
        const bool resting = end == begin && impacts > 0;
        if (resting) return {0, 0, impulse + data.mass * data.gravity * (t - begin), -1};
        if (t <= end) {
            const BounceState state = flight.at(u0, v0, t - begin);
            return {std::max(state.u, 0.0), state.v, impulse, impacts};
        }
        // The speed of arrival from the energy: exact however long the flight.
        const double arrival =
            std::sqrt(v0 * v0 + u0 * (2 * data.gravity + flight.frequency * flight.frequency * u0));
        impulse += data.mass * (1 + restitution) * arrival;
        begin = end;
        u0 = 0;
        v0 = restitution * arrival;
    }
}

}  // namespace tact
