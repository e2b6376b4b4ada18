// A loop over independent blocks on several threads.
#pragma once

#include <cstddef>
#include <functional>

namespace tact {

/// Calls work(first, last) for [0, count) cut every `block`, from so many threads, the calling one among them: blocks
/// begin in order. Once work returns false no later block begins, and those before it are finished. What work throws is
/// thrown again; of several blocks the first one's. Returns whether all were worked.
bool for_blocks(std::size_t count, std::size_t block, int threads,
                const std::function<bool(std::size_t first, std::size_t last)>& work);

}  // namespace tact
