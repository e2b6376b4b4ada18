// Work beside what is measured: in a process of its own, on a processor that is left to it.
#pragma once

#include <sched.h>
#include <sys/types.h>

#include <atomic>
#include <functional>

#include "progress.hpp"

namespace tact::bench {

/// Runs work in a copy of this process, at the lowest priority and without progress bars, on the last processor this one may
/// use. This process leaves it that processor and those that share its core until the work has ended.
class Beside {
public:
    /// Whether a processor with a core of its own is left for us.
    static bool possible();

    /// Starts `work`, which says in `done` how far it is and returns an exit code. NumericalError without a further process.
    explicit Beside(const std::function<int(std::atomic<int>& done)>& work);
    Beside(const Beside&) = delete;
    Beside& operator=(const Beside&) = delete;
    /// Ends the work if it has not ended, as Ctrl-C would.
    ~Beside();

    int done() const { return done_->load(); }
    /// Waits for the end, shown by `progress`: the exit code, or minus the signal that has ended it. Interrupted.
    int wait(Progress& progress);

private:
    bool ended(int options);
    pid_t process_ = 0;  // 0: has ended
    int status_ = 0;
    cpu_set_t ours_before_;
    std::atomic<int>* done_;  // in memory that both processes see
};

}  // namespace tact::bench
