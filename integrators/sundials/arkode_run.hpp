// ARKODE's memory and what it is asked for: the inside of Arkode.
#pragma once

#include "arkode.hpp"

namespace tact::sundials {

/// A run of Arkode: at the grid's dt unless `adaptive`.
std::unique_ptr<Run> arkode_run(const Shared<ContactProblem>& problem, const TimeGrid& grid,
                                const ContactWorkspace& workspace, const ButcherTable& table,
                                const Arkode::Options& options, bool adaptive);

}  // namespace tact::sundials
