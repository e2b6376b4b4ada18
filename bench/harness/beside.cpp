#include "beside.hpp"

#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <fstream>
#include <new>
#include <string>
#include <thread>

#include "../../lib/errors.hpp"
#include "interrupt.hpp"
#include "isolated.hpp"

namespace tact::bench {
namespace {

cpu_set_t allowed() {
    cpu_set_t set;
    CPU_ZERO(&set);
    sched_getaffinity(0, sizeof set, &set);
    return set;
}

/// The processors of one core: "1,3" or "2-3" in the kernel's words.
cpu_set_t core_of(int processor) {
    cpu_set_t core;
    CPU_ZERO(&core);
    CPU_SET(processor, &core);
    std::ifstream in("/sys/devices/system/cpu/cpu" + std::to_string(processor) + "/topology/thread_siblings_list");
    for (int from = 0; in >> from; in.ignore()) {
        int to = from;
        if (in.peek() == '-') in.ignore() >> to;
        for (int k = from; k <= to; ++k) CPU_SET(k, &core);
    }
    return core;
}

struct Division {
    cpu_set_t ours, theirs;
};
Division divide(const cpu_set_t& all) {
    int last = 0;
    for (int k = 0; k < CPU_SETSIZE; ++k)
        if (CPU_ISSET(k, &all)) last = k;
    Division division{all, {}};
    CPU_ZERO(&division.theirs);
    CPU_SET(last, &division.theirs);
    const cpu_set_t core = core_of(last);
    for (int k = 0; k < CPU_SETSIZE; ++k)
        if (CPU_ISSET(k, &core)) CPU_CLR(k, &division.ours);
    return division;
}

}  // namespace

bool Beside::possible() {
    const Division division = divide(allowed());
    return CPU_COUNT(&division.ours) > 0;
}

Beside::Beside(const std::function<int(std::atomic<int>& done)>& work) : ours_before_(allowed()) {
    void* shared = mmap(nullptr, sizeof *done_, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (shared == MAP_FAILED) throw NumericalError("beside: no shared memory");
    done_ = new (shared) std::atomic<int>(0);
    const Division division = divide(ours_before_);
    process_ = copy_process();
    if (process_ > 0) {
        sched_setaffinity(0, sizeof division.ours, &division.ours);
        return;
    }
    prctl(PR_SET_PDEATHSIG, SIGTERM);  // it is of no use to anybody without us
    sched_setaffinity(0, sizeof division.theirs, &division.theirs);
    constexpr int lowest_priority = 19;
    setpriority(PRIO_PROCESS, 0, lowest_priority);
    hide_progress();
    [&]() noexcept { _exit(work(*done_)); }();  // nothing may leave for what the parent goes on with
}

Beside::~Beside() {
    if (process_ > 0) {
        kill(process_, SIGTERM);
        while (!ended(0)) {}
    }
    munmap(done_, sizeof *done_);
}

int Beside::wait(Progress& progress) {
    constexpr std::chrono::milliseconds often(100);
    while (!ended(WNOHANG)) {
        progress.at(done());
        std::this_thread::sleep_for(often);
    }
    throw_if_interrupted();
    return WIFEXITED(status_) ? WEXITSTATUS(status_) : -WTERMSIG(status_);
}

bool Beside::ended(int options) {
    if (process_ == 0) return true;
    if (const pid_t which = waitpid(process_, &status_, options); which == 0 || (which < 0 && errno == EINTR))
        return false;
    process_ = 0;
    sched_setaffinity(0, sizeof ours_before_, &ours_before_);
    return true;
}

}  // namespace tact::bench
