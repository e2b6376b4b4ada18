// The paper's Figure 13: how few snapshots in time a reduced model of the plates can be made from.
#pragma once

#include <string>

#include "../../harness/study_options.hpp"

namespace tact::bench {

/// {"study", "size", "machine", "rows", "claims"}. A row is one basis for the run it was trained on: `selection` ("every k-th
/// step", "every k-th step, all multipliers" or "tolerance") with its `stride` or `tolerance`, the snapshots it keeps and
/// their share in %, p and p_lambda, and the error (eq. 17 as printed, and its root). Each selection is asked for some p
/// around the paper's, for a single one tells little: contact amplifies small changes of a basis. NumericalError that
/// names the step if a contact solve does not converge; Interrupted.
Json run_downsampling(const StudyOptions& options);

std::string downsampling_table(const Json& json);
std::string downsampling_markdown(const Json& json);

const Study& downsampling_study();

}  // namespace tact::bench
