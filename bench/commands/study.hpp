// `tact-bench NAME`: one study.
#pragma once

#include "../harness/study.hpp"
#include "command.hpp"

namespace tact::bench {

/// Runs the study, shows its table and leaves its three files.
Command study_command(const Study& study);

}  // namespace tact::bench
