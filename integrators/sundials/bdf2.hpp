// The paper's scheme: BDF2 at a fixed step, contact at the end of the step.
#pragma once

#include "../../lib/time/integrator.hpp"

namespace tact {

/// y_n+1 = (4 y_n - y_n-1 + 2 dt y'_n+1) / 3 on y = (u, v), first step backward Euler; the contact conditions hold
/// for u_n+1. Loads and gaps are taken at t_n+1 (right limit where they jump). Order 2 in smooth motion. An impact is
/// resolved by the scheme itself, so its restitution depends on where in a step it falls (between about .35 and 1.25
/// for a single mass): the membrane and plates average this over many nodes. Unknowns are SUNDIALS vectors and the
/// stage a SUNNonlinearSolver; nothing is allocated after the first two steps. InputError for static problems.
class Bdf2 final : public Integrator {
public:
    std::string name() const override { return "bdf2"; }
    std::unique_ptr<Run> start(const Shared<ContactProblem>& problem, const TimeGrid& grid,
                               const ContactWorkspace& workspace) const override;
};

}  // namespace tact
