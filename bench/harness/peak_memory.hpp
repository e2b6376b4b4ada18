// The most memory a part of a run holds.
#pragma once

#include <optional>

namespace tact::bench {

/// The most bytes this process has held since `reset_peak_memory`, or since it began; empty where the system does not say.
std::optional<double> peak_memory();
/// False where the system does not allow it: peaks are then those since the process began.
bool reset_peak_memory();

}  // namespace tact::bench
