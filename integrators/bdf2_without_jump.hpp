// BDF2 whose history does not remember the velocity jump of an impact.
#pragma once

#include "../lib/time/integrator.hpp"

namespace tact {

/// BDF2 with the impact law at velocity level. With A = a^2 M + a D + K, a = 3/(2h) and the history (ub, vb):
///   u1, nu: the BDF2 step with the contact conditions on u1;   w = v_BDF2 - (M + D/a)^-1 B' nu / a;
///   v1 = w + M^-1 B_C' P,  0 <= B_C v1 + e B_C v0  _|_  P >= 0  on C = {nu > 0};   lambda = P / h;
///   d_u = M^-1 B' nu / a^2,  d_v = v1 - w;   the next history is (u0 + d_u - h d_v, v0 + d_v):
/// what the step would have come from, had it moved freely to where it ended. First step backward Euler (a = 1/h).
///
/// Equal to Bdf2 in free flight; order 2 in smooth motion; penetration zero, restitution e whatever the phase of the
/// impact. With constant gaps a safeguard looks at the energy from the first step that ends in contact to the second
/// free one: where it would exceed what there was before plus the work of the load (bars whose first period is no longer than h:
/// by up to 4 E0 in the free step after an impact), the step is taken again by the theta-method with theta = 2/3, which
/// has the same matrix and gains none at any h. Steps that resolve the motion never need it. For e > 0 another one acts
/// in steps that end in contact (impact.hpp). M is needed: second order only.
class Bdf2WithoutJump final : public Integrator {
public:
    /// InputError unless 0 <= e <= 1.
    explicit Bdf2WithoutJump(double restitution = 0);
    std::string name() const override;
    std::unique_ptr<Run> start(const Shared<ContactProblem>& problem, const TimeGrid& grid,
                               const ContactWorkspace& workspace) const override;

private:
    double restitution_;
};

}  // namespace tact
