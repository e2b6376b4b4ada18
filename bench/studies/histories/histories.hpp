// The paper's Figures 4, 5, 7, 8, 9, 11 and 12: slices, surfaces and time histories of full and reduced runs.
#pragma once

#include <string>

#include "../../harness/study_options.hpp"

namespace tact::bench {

/// {"study", "size", "machine", "rows", "claims", "slices", "histories", "surfaces"}. A row is one run that figures are drawn of: its
/// scene and gamma, p and p_lambda, the error (eqs. 16 and 17 as printed, and its root) of the reduced run and of the one whose
/// dual basis are singular vectors, where there is one (null, with "singular_vectors_outcome", where that did not
/// converge), and the paper's claim. `claims`: what the paper says of singular
/// vectors, with our figure. The other three hold what is drawn: numbers to six decimals, the plates'
/// displacements each from its own rest. NumericalError that names the step if another contact solve does not converge;
/// Interrupted.
Json run_histories(const StudyOptions& options);

std::string histories_table(const Json& json);
std::string histories_markdown(const Json& json);

const Study& histories_study();

}  // namespace tact::bench
