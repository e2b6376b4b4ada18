// Where integrators break: hard steps, stiffnesses, gaps, impacts and rows, each ended right or with an honest outcome.
#pragma once

#include <string>
#include <vector>

#include "../../harness/study.hpp"

namespace tact::bench {

struct StabilityOptions {
    bool small = false;                    ///< fewer elements and steps, plates 20 x 20; seconds instead of minutes
    std::vector<std::string> groups = {};  ///< of cases; empty: all, with the tables of restitution and reduction
    std::vector<std::string> integrators = {};  ///< as bench/methods.hpp names them; empty: all
};

/// {"study", "size", "machine", "rows": [{"case", "group", "integrator", "outcome", "judgement", "steps",
/// "energy_ratio_max", "penetration_max", "kkt_residual_max", "error", "message"}], "restitution", "membrane",
/// "gap_sensitivity", "reduced_error"}; stability_markdown defines the fields. Each row in a process of its own with a limit
/// of CPU time. InputError for an unknown group or integrator; Interrupted.
Json run_stability(const StabilityOptions& options);

/// Its tables for the terminal, and the page with them.
std::string stability_table(const Json& json);
std::string stability_markdown(const Json& json);

const Study& stability_study();

}  // namespace tact::bench
