// Work in a process of its own: what runs out of time or memory, or crashes, costs a study one row and not the run.
#pragma once

#include <sys/types.h>

#include <functional>
#include <string>
#include <vector>

#include "machine.hpp"

namespace tact::bench {

/// Runs `work` in a copy of this process with so many seconds of CPU time and most of the machine's memory. Returns its
/// value, or {"error": why} where it threw, crashed or was out of time or memory. With "peak_bytes": what its memory grew
/// by at most. Interrupted.
Json isolated(const std::function<Json()>& work, double cpu_seconds);

/// A copy of this process, from fork(); the threads that OpenMP keeps are given back first. NumericalError where there is none.
pid_t copy_process();

/// What run_program says of a program that SIGPROF has ended.
inline constexpr const char* own_timer = "ended by its own timer";

/// Runs a program with these words, silent and likewise limited. Empty where it ended with code 0, else why not. Interrupted.
std::string run_program(const std::vector<std::string>& words, double cpu_seconds);

}  // namespace tact::bench
