// Full and reduced models in one diagram: error against run time.
#pragma once

#include <string>

#include "../../harness/study_options.hpp"

namespace tact::bench {

/// {"study", "size", "machine", "references", "rows", "break_even", "rivals"}. All errors are of u at the nodes that all grids share, at
/// common times, against one reference per scene on a finer grid with a finer step.
///   references: {"scene", "parameter", "integrator", "n", "dt", "own_error_percent"}: its distance to a reference half as fine;
///   rows: {"scene", "model": "full" or "reduced", "integrator", "n", "dt", "p", "p_lambda", "dual_basis", "seconds",
///     "training_seconds", "error_percent", "error_norm_percent", "training_model": whether reduced models learn from it}. A full
///     run's seconds have its set-up in them; a reduced one's are online. Errors as printed in eqs. 16 and 17, and as norms.
///   break_even: {"scene", "integrator", "p", "error_percent", "full": {"n", "dt", "integrator", "seconds"}, "queries"}: from so many
///     queries on a reduced model, its training included, is cheaper than the cheapest full model at least as accurate
///     (null: there is none).
///   rivals: {"scene", "reduced", "training_model", "full"}: rows, with the paper's scheme the reduced model with most selected
///     rows and the full one it learnt from, and the cheapest full model of any integrator on a coarser grid whose error is no
///     larger than the reduced one's (null: there is none).
/// InputError for a scene that is none; NumericalError if a run fails; Interrupted.
Json run_tradeoff(const StudyOptions& options);

std::string tradeoff_table(const Json& json);
std::string tradeoff_markdown(const Json& json);

const Study& tradeoff_study();

}  // namespace tact::bench
