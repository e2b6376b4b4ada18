// The hard cases of the stability study, as data.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "../../../lib/time/integrator.hpp"

namespace tact::bench {

/// What an integrator is asked to survive.
struct StabilityCase {
    std::string group = {}, name = {};
    ContactProblem problem = {};
    TimeGrid grid = {};
    /// u(t_end) for impacts with this restitution, NaN where the integrator has none of its own; empty vector: not known.
    std::function<Vector(double t, double restitution)> exact = {};
    /// A problem of the same solution: the same integrator's answer to it is then the reference.
    std::optional<ContactProblem> twin = {};
    double error_limit =
        infinity;       ///< beyond it the answer is wrong; finite where every consistent method must be within
    double length = 1;  ///< errors are relative to max(|u|, length)
    double energy = 0;  ///< added to the scale of the energy: not zero where neither E0 nor work is
    double energy_tolerance = 1e-6;  ///< what may be gained, in that scale
    bool fixed_steps = false;        ///< says nothing about adaptive methods
    bool rejected = false;           ///< an InputError that names the row is the right answer
    InitialPenetration initial = InitialPenetration::reject;
};

/// All groups, in order. `small`: fewer elements and steps.
std::vector<StabilityCase> stability_cases(bool small);

}  // namespace tact::bench
