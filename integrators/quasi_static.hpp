// Equilibrium after equilibrium under a load and a gap that move slowly.
#pragma once

#include "../lib/time/integrator.hpp"

namespace tact {

/// K u + r(u) = f(t_n) + B' lambda with the contact conditions at each t_n: the a = 0 stage, warm from step to step. The
/// initial state is u0, or zero where the problem gives none. InputError for problems with M or D.
class QuasiStatic final : public Integrator {
public:
    std::string name() const override { return "quasi-static"; }
    std::unique_ptr<Run> start(const Shared<ContactProblem>& problem, const TimeGrid& grid,
                               const ContactWorkspace& workspace) const override;
};

}  // namespace tact
