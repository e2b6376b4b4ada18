// The study of the online layer: what a stored model costs to ask, and how far its answers can be trusted.
#pragma once

#include <string>

#include "../../harness/study_options.hpp"

namespace tact::bench {

/// {"study", "size", "machine", "rows"}, a row for each scene and size:
///   "scene", "n", "p", "p_lambda", "steps", "gap_rows" (of the full problem the gap is known from), "series" (polynomials),
///   "parameter_error", "build_seconds", "file_bytes", "save_seconds", "load_seconds", "same_bits" (answers of the loaded model);
///   "us_problem" (the reduced problem at gamma), "us_query", "us_query_checked", medians of CPU time; "schur_condition";
///   "calibrated_on", "tests", "error_percent" (largest, |U q - u| / |u| over all steps);
///   "estimate": {"least", "median", "largest"} over the tests of estimate / error, and "below" of them underestimated;
///   "bound": the same of the energy bound over the error in the energy norm and "us_bound"; null in time.
/// InputError for a bad option; NumericalError if a run fails; Interrupted.
/// Scenes: static-obstacle, dynamic-obstacle.
Json run_online(const StudyOptions& options);

std::string online_table(const Json& json);
std::string online_markdown(const Json& json);

const Study& online_study();

}  // namespace tact::bench
