// The trapezoid rule with the impact law at velocity level, and its family with numerical damping.
#pragma once

#include "../lib/time/integrator.hpp"

namespace tact {

/// Trapezoid with velocity projection. A step solves, with A = M + h/2 D + h^2/4 K and g(u) = B u - c,
///   u* = A^-1 [M (u0 + h v0) + h/2 D u0 + h^2/4 (f0 + f1 - K u0)],
///   u1 = u* + A^-1 B' nu,  0 <= g(u1)  _|_  nu >= 0,
///   (M + h/2 D) w = (M - h/2 D) v0 + h/2 (f0 - K u0 + f1 - K u1),
///   v1 = w + M^-1 B_C' P,  0 <= B_C v1 + e B_C v0  _|_  P >= 0  on the closed rows C = {nu > 0},
/// and reports lambda = P / h, the mean over the step. f0 is a right limit, f1 a left one.
///
/// Order 2 in smooth motion. Penetration is zero and the restitution is e, whatever the phase of the impact in its step.
/// Energy (f = 0, D = 0, c constant, e = 0, g(u0) >= 0, any h, full or reduced):
///   E1 - E0 <= -(2/h^2) nu' g(u0) <= 0,   see docs/integrators.md for the proof;
/// for e > 0 or rho < 1 a safeguard keeps E from growing in steps that end in contact. (Free steps with rho < 1 keep
/// another energy: 3.7 E0 was seen in a bar whose first period is a fifteenth of h.)
///
/// rho < 1, the spectral radius at infinity, damps high frequencies: the generalised-alpha family (Chung, Hulbert 1993)
/// with the same projections (Bruls, Acary, Cardona 2014). Problems of first order: Crank-Nicolson, contact at the end
/// of the step, rho = 1 only.
class Trapezoid final : public Integrator {
public:
    struct Options {
        double rho = 1;          ///< from 0 to 1
        double restitution = 0;  ///< e, from 0 to 1
    };
    Trapezoid() : Trapezoid(Options{}) {}
    /// InputError unless both are from 0 to 1.
    explicit Trapezoid(const Options& options);

    std::string name() const override;
    std::unique_ptr<Run> start(const Shared<ContactProblem>& problem, const TimeGrid& grid,
                               const ContactWorkspace& workspace) const override;

private:
    Options options_;
};

}  // namespace tact
