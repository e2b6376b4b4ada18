#include "../../../rom/bases/parallel_blocks.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <mutex>
#include <set>
#include <stdexcept>
#include <thread>
#include <vector>

namespace tact {
namespace {

TEST(ForBlocks, WorksEveryPlaceOnce) {
    for (const int threads : {1, 2, 7}) {
        std::vector<std::atomic<int>> hits(23);
        EXPECT_TRUE(for_blocks(23, 5, threads, [&](std::size_t first, std::size_t last) {
            EXPECT_EQ(first % 5, 0u);
            EXPECT_LE(last, std::min<std::size_t>(first + 5, 23));
            for (std::size_t j = first; j < last; ++j) ++hits[j];
            return true;
        }));
        for (const auto& hit : hits) EXPECT_EQ(hit, 1);
    }
    EXPECT_TRUE(for_blocks(0, 5, 3, [](std::size_t, std::size_t) { return false; }));
}

TEST(ForBlocks, UsesTheThreadsItIsGiven) {
    std::mutex mutex;
    std::set<std::thread::id> seen;
    std::atomic<int> arrived = 0;
    (void)for_blocks(3, 1, 3, [&](std::size_t, std::size_t) {
        {
            const std::lock_guard lock(mutex);
            seen.insert(std::this_thread::get_id());
        }
        for (++arrived; arrived < 3;) std::this_thread::yield();  // until all three are at work
        return true;
    });
    EXPECT_EQ(seen.size(), 3u);
    EXPECT_TRUE(seen.contains(std::this_thread::get_id()));
}

TEST(ForBlocks, FinishesWhatIsBeforeTheEndAndThrowsTheFirstError) {
    for (const int threads : {1, 4}) {
        std::vector<std::atomic<int>> hits(40);
        EXPECT_FALSE(for_blocks(40, 2, threads, [&](std::size_t first, std::size_t) {
            ++hits[first];
            return first != 20;
        }));
        for (std::size_t j = 0; j <= 20; j += 2) EXPECT_EQ(hits[j], 1) << j;
        try {
            (void)for_blocks(40, 2, threads, [](std::size_t first, std::size_t) -> bool {
                if (first >= 6) throw std::runtime_error(std::to_string(first));
                return true;
            });
            FAIL() << "it was to throw";
        } catch (const std::runtime_error& error) {
            EXPECT_EQ(std::string(error.what()), "6");
        }
    }
}

}  // namespace
}  // namespace tact
