// What a program beside tact-bench loads before it starts.
#pragma once

#include <string>

#include "machine.hpp"

namespace tact::bench {

/// {"program", "does", "components", "bytes", "libraries", "left_out", "startup_seconds"}: the libraries the dynamic linker
/// loads for it, those of tact's that it does not need, and the median wall time of running it. NumericalError if it
/// cannot be run or does not end with code 0.
Json online_program(const std::string& name, const std::string& does, const std::string& components);

}  // namespace tact::bench
