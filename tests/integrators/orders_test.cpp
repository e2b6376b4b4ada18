// Observed orders by halving the step against exact motions, for every fixed-step integrator.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "../../contact/dense/dense_contact.hpp"
#include "../../integrators/bdf2_without_jump.hpp"
#include "../../integrators/central_difference.hpp"
#include "../../integrators/moreau_jean.hpp"
#include "../../integrators/quasi_static.hpp"
#include "../../integrators/sundials/arkode.hpp"
#include "../../integrators/sundials/bdf2.hpp"
#include "../../integrators/sundials/ida.hpp"
#include "../../integrators/trapezoid.hpp"

namespace tact {
namespace {

struct Expected {
    std::shared_ptr<const Integrator> method;
    double free = 2;                  ///< of u and v in free motion
    double u = 2, v = 2, lambda = 2;  ///< in persistent contact
    double lambda_at = 1;             ///< where in its step the reported lambda is meant: 1/2 for a mean
};

std::vector<Expected> integrators() {
    std::vector<Expected> all;
    all.push_back({std::make_shared<Bdf2>()});
    all.push_back({std::make_shared<Ida>(Ida::fixed_step())});
    all.push_back({std::make_shared<Trapezoid>(), 2, 2, 2, 2, 0.5});
    all.push_back({std::make_shared<Trapezoid>(Trapezoid::Options{0.3, 0}), 2, 2, 2, 2, 0.5});
    all.push_back({std::make_shared<Bdf2WithoutJump>(), 2, 2, 2, 2, 0.5});
    all.push_back({std::make_shared<CentralDifference>(), 2, 2, 2, 2, 0.5});
    all.push_back({std::make_shared<MoreauJean>(), 2, 2, 2, 2, 0.5});
    all.push_back({std::make_shared<Arkode>(sdirk2())});
    all.push_back({std::make_shared<Arkode>(tr_bdf2())});
    all.push_back({std::make_shared<Arkode>(esdirk32()), 3, 3, 3, 3});
    all.push_back({std::make_shared<Arkode>(sdirk54()), 4, 4, 4, 4});
    // With an impact law lambda is a mean over the step, of order 2 at its middle.
    all.push_back({std::make_shared<Arkode>(sdirk2(), 0), 2, 2, 2, 2, 0.5});
    all.push_back({std::make_shared<Arkode>(esdirk32(), 0), 3, 3, 3, 2, 0.5});
    all.push_back({std::make_shared<Arkode>(sdirk54(), 0), 4, 4, 4, 2, 0.5});
    return all;
}

struct Errors {
    double u = 0, v = 0, lambda = 0;
};

double order(double coarse, double fine) { return std::log2(coarse / fine); }

/// u'' + .2 u' + 4 u = cos 3t + sin t, exact for u = sin t + cos 3t by its load.
Errors free_motion(const Integrator& method, double dt) {
    ContactProblem p;
    p.M = Matrix::identity(1);
    p.D = Matrix::diagonal(Vector::Constant(1, 0.2));
    p.K = Matrix::diagonal(Vector::Constant(1, 4.0));
    p.B = Matrix::without_rows(1);
    p.f = AffineVector(DenseMatrix(DenseMatrix::Ones(1, 1)), [](double t, Side, VectorRef out) {
        out[0] = (4 - 1) * std::sin(t) + (4 - 9) * std::cos(3 * t) + 0.2 * (std::cos(t) - 3 * std::sin(3 * t));
    });
    p.u0 = Vector::Ones(1);
    p.v0 = Vector::Ones(1);
    ContactWorkspace workspace(std::make_shared<DenseContact>());
    const auto march = integrate(method, p, TimeGrid::until(2, dt), workspace);
    EXPECT_EQ(march.outcome, Outcome::converged) << method.name();
    return {std::abs(march.final_state.u()[0] - std::sin(2) - std::cos(6)),
            std::abs(march.final_state.v()[0] - std::cos(2) + 3 * std::sin(6)), 0};
}

/// A mass pressed on a stop for good, coupled to one that swings: u = (0, cos(sqrt(2) t) / 2), lambda = 5 - u_2.
Errors persistent_contact(const Integrator& method, double dt, double lambda_at) {
    ContactProblem p;
    p.M = Matrix::identity(2);
    p.K = Matrix(DenseMatrix{{2, -1}, {-1, 2}});
    p.B = Matrix(DenseMatrix{{1, 0}});
    p.c = Vector(Vector::Zero(1));
    p.f = Vector(Vector{{-5, 0}});
    p.u0 = Vector{{0, 0.5}};
    p.v0 = Vector::Zero(2);
    ContactWorkspace workspace(std::make_shared<DenseContact>());
    const auto march = integrate(method, p, TimeGrid::until(2, dt), workspace);
    EXPECT_EQ(march.outcome, Outcome::converged) << method.name();
    const double w = std::sqrt(2.0), t = 2 - (1 - lambda_at) * dt;
    EXPECT_NEAR(march.final_state.u()[0], 0, 1e-14) << method.name();
    return {std::abs(march.final_state.u()[1] - 0.5 * std::cos(2 * w)),
            std::abs(march.final_state.v()[1] + 0.5 * w * std::sin(2 * w)),
            std::abs(march.final_state.lambda[0] - 5 + 0.5 * std::cos(w * t))};
}

TEST(Orders, InFreeDampedMotion) {
    for (const Expected& each : integrators()) {
        const double dt = each.free > 2 ? 0.02 : 0.0025;
        const Errors coarse = free_motion(*each.method, dt), fine = free_motion(*each.method, dt / 2);
        EXPECT_NEAR(order(coarse.u, fine.u), each.free, 0.2) << each.method->name();
        EXPECT_NEAR(order(coarse.v, fine.v), each.free, 0.2) << each.method->name();
    }
}

TEST(Orders, InPersistentContact) {
    for (const Expected& each : integrators()) {
        const double dt = each.u > 3 ? 0.04 : 0.01;  // above rounding
        const Errors coarse = persistent_contact(*each.method, dt, each.lambda_at),
                     fine = persistent_contact(*each.method, dt / 2, each.lambda_at);
        EXPECT_NEAR(order(coarse.u, fine.u), each.u, 0.2) << each.method->name();
        EXPECT_NEAR(order(coarse.v, fine.v), each.v, 0.2) << each.method->name();
        EXPECT_NEAR(order(coarse.lambda, fine.lambda), each.lambda, 0.2) << each.method->name();
    }
}

}  // namespace
}  // namespace tact
