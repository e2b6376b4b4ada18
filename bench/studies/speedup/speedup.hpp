// The paper's Table I: online speed-ups of the three contact problems, with errors and certificates.
#pragma once

#include <string>
#include <vector>

#include "../../harness/machine.hpp"

namespace tact::bench {

struct SpeedupOptions {
    bool small = false;  ///< membrane 60 x 60, plates 40 x 40; bases, candidates and tests a quarter
    int repeats = 5;
    std::string bases = "default";  ///< or "paper": by the paper's method (see default_training, paper_training)
    std::vector<std::string> scenes = {};  ///< rows wanted; empty: all three
};

/// {"study", "size", "repeats", "machine", "bases", "rows": [one a scene]}. Per row: sizes; `full_seconds` of the fastest full
/// solver with everything cached that does not depend on the query and `full_cold_seconds` without; the same run by KLU
/// refactorisation and by IPOPT, marches from a sample of their steps ("extrapolated" says how); `reduced_seconds` of the
/// online part; speed-ups; the worst error over parameters outside the training set. CPU time of one thread, medians.
/// NumericalError that names the step if a contact solve does not converge; Interrupted.
Json run_speedup(const SpeedupOptions& options);

/// Its table for the terminal, and the page with it.
std::string speedup_table(const Json& json);
std::string speedup_markdown(const Json& json);

}  // namespace tact::bench
