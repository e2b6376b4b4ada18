// The paper's Table I: online speed-ups of the three contact problems, with errors and certificates.
#pragma once

#include <string>
#include <vector>

#include "../../harness/study.hpp"

namespace tact::bench {

struct SpeedupOptions {
    bool small = false;  ///< membrane 60 x 60, plates 40 x 40; bases, candidates and tests a quarter
    int repeats = 5;
    std::string bases =
        "both";  ///< or "default": ours alone, "paper": the paper's alone (default_training, paper_training)
    std::vector<std::string> scenes = {};  ///< rows wanted; empty: all three
};

/// {"study", "size", "repeats", "bases", "machine", "rows": [one a scene and method], "load_average": of the machine at the
/// end}. Per row: `method`: "ours" or "the paper's"; sizes; `full_seconds` of the fastest full solver with everything cached
/// that does not depend on the query and `full_cold_seconds` without; the same run by KLU refactorisation and by IPOPT,
/// marches from a sample of their steps ("extrapolated" says how); `reduced_seconds` of the online part; speed-ups; over
/// parameters outside every training set the worst error, `relative_error_percent` (squared, eqs. 16 and 17 as printed) and
/// its root `relative_error_norm` (a fraction). Full runs are timed once a scene. CPU time of one thread, medians.
/// NumericalError that names the step if a contact solve does not converge; Interrupted.
Json run_speedup(const SpeedupOptions& options);

/// Its table for the terminal, and the page with it.
std::string speedup_table(const Json& json);
std::string speedup_markdown(const Json& json);

const Study& speedup_study();

}  // namespace tact::bench
