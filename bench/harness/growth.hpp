// How a step and its memory grow with the number of unknowns.
#pragma once

#include <string>
#include <vector>

#include "../../lib/types.hpp"
#include "machine.hpp"

namespace tact::bench {

struct GrowthOptions {
    std::string scene = {};         ///< one with steps
    std::vector<Index> sides = {};  ///< nodes a side
    double t_end = 0;               ///< the same physical time at every size; 0: the paper's
    double limit = 120;             ///< CPU s a size; what ends later is reported as far as it came
};

/// {"scene", "points": [{"n", "unknowns", "steps", "contact_steps", "most_active", "prepare_seconds", "free_seconds",
/// "contact_seconds", "peak_bytes", "bytes_per_unknown", "strategy"}], "free_exponent", "contact_exponent",
/// "memory_exponent"}: medians over the steps with and without contact of the contact solves of the chooser's march, at the
/// paper's dt; the peak of the memory of the whole run, scene included; least-squares slopes over the logarithms, null with
/// fewer than two points. A point that fails has "error". Each size in a process of its own. Interrupted.
Json run_growth(const GrowthOptions& options);

/// Slope of log y over log x; null for fewer than two pairs of positive numbers.
Json fitted_exponent(const std::vector<double>& x, const std::vector<double>& y);

}  // namespace tact::bench
