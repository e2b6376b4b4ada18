// Counts what this program allocates.
#pragma once

namespace tact::testing {

#ifndef __SANITIZE_ADDRESS__  // which brings its own malloc
#define TACT_COUNTS_ALLOCATIONS
/// Calls of malloc by this thread so far: Eigen's vectors come from there, not from operator new.
long allocations();
#endif

}  // namespace tact::testing
