// What grows with what: full models with their size and contact, reduced ones with their bases, steps, queries, threads.
#pragma once

#include <string>

#include "../../harness/study_options.hpp"

namespace tact::bench {

/// {"study", "size", "machine", "rows"}: a row a series {"of", "with", "unit", "points": [{"x", "seconds", "bytes"}], "exponent",
/// "memory_exponent"}: CPU seconds (threads: wall) of one `unit`; slopes fitted over logarithms. Full models: a step in contact at the
/// same physical time, and the peak memory of the whole run. Takes no scenes. NumericalError if a run fails; Interrupted.
Json run_growth_study(const StudyOptions& options);

std::string growth_table(const Json& json);
std::string growth_markdown(const Json& json);

const Study& growth_study();

}  // namespace tact::bench
