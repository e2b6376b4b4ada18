// Ctrl-C: a flag that long loops look at, so that a run ends between two steps and leaves whole files or none.
#pragma once

#include <exception>

#include "../../lib/time/integrator.hpp"

namespace tact::bench {

/// Makes SIGINT and SIGTERM set the flag instead of ending the process. A second signal ends it at once.
void catch_interrupts();
bool interrupted();

struct Interrupted : std::exception {
    const char* what() const noexcept override { return "interrupted"; }
};
/// Throws Interrupted if a signal has come.
void throw_if_interrupted();
/// For marches: says stop if a signal has come.
Observer stop_on_interrupt();

}  // namespace tact::bench
