// How every study measures: CPU time of the one thread, medians over repeats.
#pragma once

#include <ctime>
#include <vector>

namespace tact::bench {

/// CPU seconds of the calling thread: use_one_thread sees to it that there is no other. Other processes on the machine do
/// not add to it. (The clock of the process is as coarse as the kernel's tick under a limit of CPU time, see isolated.)
inline double cpu_seconds() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// The middle value, or the mean of the two middle ones; NaN of nothing.
double median(std::vector<double> values);

/// CPU seconds of one call.
template <class Work> double seconds_of(Work&& work) {
    const double start = cpu_seconds();
    work();
    return cpu_seconds() - start;
}

/// Median over `repeats` calls.
template <class Work> double median_seconds(int repeats, Work&& work) {
    std::vector<double> times;
    for (int k = 0; k < repeats; ++k) times.push_back(seconds_of(work));
    return median(std::move(times));
}

}  // namespace tact::bench
