// What training costs, by part, and after how many queries it has paid.
#pragma once

#include <string>

#include "../../harness/study_options.hpp"

namespace tact::bench {

/// {"study", "size", "machine", "rows", "scenes"}. A row is one iteration: the full solves so far and what they and the rest
/// have taken up to there, CPU seconds by part: `full_run`, `pod`, `dual_basis`, `projection` (modal coordinates, reduction,
/// the indicator's matrices), `candidates`. A scene has the totals, also elapsed; those with two threads and whether the bases are
/// then the same to the last bit; `peak_megabytes` by part, above what was held before; and the queries after which training has
/// paid: its CPU time over what a reduced run saves. NumericalError that names the step if a run fails; Interrupted.
Json run_training(const StudyOptions& options);

std::string training_table(const Json& json);
std::string training_markdown(const Json& json);

const Study& training_study();

}  // namespace tact::bench
