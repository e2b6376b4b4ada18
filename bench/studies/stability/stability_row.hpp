// One integrator on one hard case: what is watched, and how it is judged.
#pragma once

#include <string>
#include <vector>

#include "../../harness/machine.hpp"
#include "stability_cases.hpp"

namespace tact::bench {

/// Every integrator of bench/methods.hpp, with each restitution it takes, fixed and adaptive.
std::vector<std::string> stability_integrators();
/// The restitution of an integrator's impact law; NaN where its impacts are what the scheme makes of them.
double restitution_of(const std::string& integrator);

/// Whether the case asks something of this integrator.
bool applies(const StabilityCase& problem, const std::string& integrator);

/// One of "rows" of run_stability: a march in a process of its own, every step watched. Interrupted.
Json stability_row(const StabilityCase& problem, const std::string& integrator, double cpu_seconds);

}  // namespace tact::bench
