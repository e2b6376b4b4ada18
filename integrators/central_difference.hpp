// Central differences: explicit, with the contact conditions on the end of every step.
#pragma once

#include "../lib/time/integrator.hpp"

namespace tact {

/// Explicit central differences (velocity Verlet) with contact at position and velocity level. A step solves with M only:
///   M u1 = M (u0 + h v0) + h^2/2 (f0 - K u0 - D v0) + B' nu,   0 <= B u1 - c  _|_  nu >= 0,
///   (M + h/2 D) w = M v0 + h/2 (f0 - K u0 - D v0) + B' nu / h + h/2 (f1 - K u1),
///   v1 = w + M^-1 B_C' P,  0 <= B_C v1 + e B_C v0  _|_  P >= 0  on the closed rows C = {nu > 0},
/// and reports lambda = nu / h^2 + P / h, the mean over the step. f0 is a right limit, f1 a left one.
///
/// Stable up to h = 2 / omega, omega the largest natural frequency of (K, M), whatever D >= 0; h beyond that is an
/// InputError. Order 2 in smooth motion; penetration zero; restitution e, whatever the phase of the impact in its step.
/// Without load and damping, with constant gaps, e = 0 and a lumped M whose rows of B do not share unknowns,
///   |u1 - u0|_M^2 / (2 h^2) + u0'K u1 / 2   never grows (docs/integrators.md); M + K's own energy swings about it by
/// a share (h omega)^2 / 8 of the fast modes. With a lumped M a step costs one product with K: waves on a regular mesh
/// at h = 2 / omega travel without dispersion. Problems without M, with
/// unknowns without mass or with an r: InputError.
class CentralDifference final : public Integrator {
public:
    /// InputError unless 0 <= e <= 1.
    explicit CentralDifference(double restitution = 0);
    std::string name() const override;
    std::unique_ptr<Run> start(const Shared<ContactProblem>& problem, const TimeGrid& grid,
                               const ContactWorkspace& workspace) const override;

    /// 2 / omega, rather too small than too large: by Gershgorin's circles where M is diagonal and they find `wanted`
    /// stable, else by Lanczos steps until the largest Ritz value is known to 1e-4 (400 at most).
    static double largest_step(const ContactProblem& problem, const ContactWorkspace& workspace,
                               double wanted = infinity);

private:
    double restitution_;
};

}  // namespace tact
