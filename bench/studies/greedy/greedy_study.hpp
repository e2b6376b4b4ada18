// The paper's Figures 3 and 6: how the greedy search converges, with every weight set, the true error, and random samples.
#pragma once

#include <string>

#include "../../harness/study_options.hpp"

namespace tact::bench {

/// {"study", "size", "machine", "rows", "claims"}. A row is one basis: scene, selection (the weights of eq. 14, "true error"
/// or "Latin hypercube"), iteration or repeat, p, p_lambda, and over test parameters outside the candidates
/// `worst_error_percent` and `median_error_percent` (eqs. 16, 17 as printed) and `worst_error_norm`, the root of the worst
/// ratio. A claim is one of the paper's about these figures with our figure beside it; both are of the scenes wanted. NumericalError that names the step
/// if a contact solve does not converge; Interrupted.
Json run_greedy(const StudyOptions& options);

std::string greedy_table(const Json& json);
std::string greedy_markdown(const Json& json);

const Study& greedy_study();

}  // namespace tact::bench
