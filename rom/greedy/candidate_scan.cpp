#include "candidate_scan.hpp"

#include <array>
#include <atomic>
#include <limits>
#include <mutex>
#include <thread>

#include "../bases/parallel_blocks.hpp"

namespace tact {
namespace {

/// Large enough that preparing contact does not count, small enough for many threads.
constexpr std::size_t block_size = 5;

}  // namespace

ScanResult scan(const CandidateScan& task, const ContactFamily& reduced, const std::vector<Parameter>& candidates,
                const std::vector<bool>& skipped) {
    ScanResult result;
    result.indicators.assign(candidates.size(), std::numeric_limits<double>::quiet_NaN());
    result.failed = candidates.size();
    const std::vector<long> steps = task.method.integrator ? task.steps : std::vector<long>{0};
    const std::thread::id caller = std::this_thread::get_id();
    std::atomic<std::size_t> done = 0;
    std::atomic<bool> stopped = false;
    std::mutex failing;

    const auto fail = [&](std::size_t j, const MarchReport& report) {
        const std::lock_guard lock(failing);
        if (j >= result.failed) return;
        result.failed = j;
        result.outcome = report.outcome;
        result.failed_step = report.last.step;
    };
    const auto work = [&](std::size_t first, std::size_t last) {
        ContactWorkspace workspace(task.contact);
        ReducedStateRecorder recorder(steps);
        for (std::size_t j = first; j < last; ++j, ++done) {
            if (stopped) return false;
            if (skipped[j]) continue;
            const ContactProblem problem = reduced.at(candidates[j]);
            const std::array observers{recorder.observer(problem)};
            const MarchReport report = run_by(task.method, problem, workspace, observers);
            if (report.outcome != Outcome::converged) {
                fail(j, report);
                return false;
            }
            result.indicators[j] = task.judge(candidates[j], problem, recorder.states());
            if (std::this_thread::get_id() != caller) continue;
            const double fraction = static_cast<double>(done + 1) / static_cast<double>(candidates.size());
            if (task.progress && !task.progress(fraction)) stopped = true;
        }
        return true;
    };
    const bool shares_work_space = !candidates.empty() && reduced.at(candidates.front()).r.has_value();
    (void)for_blocks(candidates.size(), block_size, shares_work_space ? 1 : task.threads, work);
    if (stopped && result.failed == candidates.size()) result.outcome = Outcome::stopped;
    return result;
}

}  // namespace tact
