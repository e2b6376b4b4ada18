// What each scene uses and leaves out, and what that saves.
#pragma once

#include <string>

#include "../../harness/study_options.hpp"

namespace tact::bench {

/// {"study", "size", "machine", "rows", "costs", "programs"}.
///   rows:     {"scene", "part", "used", "why"}: from the problem and from one run's report;
///   costs:    {"what", "baseline", "seconds_baseline", "seconds", "over_percent", "asked_percent", "said"}: CPU time of what a
///             scene pays for parts it does not use, both timed in turn, least of the repeats;
///   programs: {"program", "does", "components", "bytes", "libraries", "left_out", "startup_seconds"}: online programs, what the
///             dynamic linker loads for them, and the wall time from their start to their end.
/// InputError for a scene that is none; Interrupted.
Json run_omission(const StudyOptions& options);

std::string omission_table(const Json& json);
std::string omission_markdown(const Json& json);

const Study& omission_study();

}  // namespace tact::bench
