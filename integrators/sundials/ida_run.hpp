// IDA's memory and what it is asked for: the inside of Ida.
#pragma once

#include "ida.hpp"

namespace tact::sundials {

/// A run of Ida: `fixed` at the grid's dt.
std::unique_ptr<Run> ida_run(const Shared<ContactProblem>& problem, const TimeGrid& grid,
                             const ContactWorkspace& workspace, const Ida::Options& options, bool fixed);

}  // namespace tact::sundials
