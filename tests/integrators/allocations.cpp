#include "allocations.hpp"

#include <cstdlib>

#ifdef TACT_COUNTS_ALLOCATIONS
namespace {
thread_local long count = 0;
}

extern "C" void* __libc_malloc(std::size_t);          // NOLINT: glibc's own
extern "C" void* malloc(std::size_t size) noexcept {  // NOLINT
    ++count;
    return __libc_malloc(size);
}

namespace tact::testing {
long allocations() { return count; }
}  // namespace tact::testing
#endif
