#include "parallel_blocks.hpp"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace tact {

bool for_blocks(std::size_t count, std::size_t block, int threads,
                const std::function<bool(std::size_t first, std::size_t last)>& work) {
    const std::size_t blocks = (count + block - 1) / block;
    std::atomic<std::size_t> next = 0;
    std::atomic<bool> ended = false;
    std::mutex mutex;
    std::size_t thrown_by = blocks;
    std::exception_ptr thrown;
    const auto work_off = [&] {
        while (!ended) {
            const std::size_t k = next++;
            if (k >= blocks) return;
            try {
                if (!work(k * block, std::min(count, (k + 1) * block))) ended = true;
            } catch (...) {
                const std::lock_guard lock(mutex);
                ended = true;
                if (k >= thrown_by) continue;
                thrown_by = k;
                thrown = std::current_exception();
            }
        }
    };
    {
        std::vector<std::jthread> others;
        const std::size_t useful = std::min(static_cast<std::size_t>(std::max(threads, 1)), blocks);
        for (std::size_t k = 1; k < useful; ++k) others.emplace_back(work_off);
        work_off();
    }
    if (thrown) std::rethrow_exception(thrown);
    return !ended;
}

}  // namespace tact
