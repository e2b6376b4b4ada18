#include "isolated.hpp"

#include <fcntl.h>
#include <malloc.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <new>
#include <string>

#include "../../lib/errors.hpp"
#include "interrupt.hpp"

// Weak: there with OpenMP.
extern "C" {
[[gnu::weak]] int omp_pause_resource_all(int);
}

namespace tact::bench {
namespace {

void limit_memory() {
    // More than the machine has would bring it to its knees, and others with it; allocations fail instead.
    const double bytes = static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
    constexpr double share = 0.7;
    const auto limit = static_cast<rlim_t>(share * bytes);
    const rlimit value{limit, limit};
    setrlimit(RLIMIT_AS, &value);
}

void limit_cpu(double seconds) {
    // The clock goes on from zero in a child. The hard limit kills what the soft one does not.
    const auto limit = static_cast<rlim_t>(std::ceil(seconds));
    const rlimit value{limit, limit + 1};
    setrlimit(RLIMIT_CPU, &value);
}

/// VmRSS or VmHWM of this process, bytes.
double memory(const std::string& field) {
    std::ifstream in("/proc/self/status");
    for (std::string line; std::getline(in, line);)
        if (line.starts_with(field + ":")) return 1024 * std::stod(line.substr(field.size() + 1));
    return 0;
}

/// In the child: the answer goes down the pipe, and nothing of the parent's is flushed or destroyed.
[[noreturn]] void answer(const std::function<Json()>& work, int pipe) {
    int code = 0;
    std::string text;
    try {
        const double before = memory("VmRSS");
        Json json = work();
        json["peak_bytes"] = std::max(0.0, memory("VmHWM") - before);
        text = json.dump();
    } catch (const std::bad_alloc&) {
        text = Json{{"error", "out of memory"}}.dump();
    } catch (const std::exception& error) {
        text = Json{{"error", error.what()}}.dump();
    }
    for (std::size_t sent = 0; sent < text.size();) {
        const ssize_t count = write(pipe, text.data() + sent, text.size() - sent);
        if (count < 0 && errno != EINTR) _exit(1);
        if (count > 0) sent += static_cast<std::size_t>(count);
    }
    _exit(code);
}

/// Waits for the child; kills it where a signal has come for us.
int wait_for(pid_t child) {
    int status = 0;
    while (waitpid(child, &status, 0) < 0) {
        if (errno != EINTR) return -1;
        if (interrupted()) kill(child, SIGKILL);
    }
    return status;
}

std::string why(int status, double cpu_seconds) {
    if (WIFSIGNALED(status)) {
        if (WTERMSIG(status) == SIGXCPU || WTERMSIG(status) == SIGKILL)
            return "out of time (" + std::to_string(std::lround(cpu_seconds)) + " s) or of memory";
        if (WTERMSIG(status) == SIGPROF) return own_timer;
        return "ended by signal " + std::to_string(WTERMSIG(status));
    }
    return "ended with code " + std::to_string(WEXITSTATUS(status));
}

}  // namespace

pid_t copy_process() {
    // OpenMP's threads are not copied with the process, and who waits for them waits for ever.
    constexpr int hard = 2;  // omp_pause_hard
    if (omp_pause_resource_all) omp_pause_resource_all(hard);
    std::fflush(nullptr);
    const pid_t child = fork();
    if (child < 0) throw NumericalError("isolated: no further process");
    return child;
}

Json isolated(const std::function<Json()>& work, double cpu_seconds) {
    throw_if_interrupted();
    malloc_trim(0);  // so that the child's memory grows by what the work takes, not into what we have left
    std::array<int, 2> ends{};
    if (pipe(ends.data()) != 0) throw NumericalError("isolated: no pipe");
    const pid_t child = copy_process();
    if (child == 0) {
        close(ends[0]);
        limit_cpu(cpu_seconds);
        limit_memory();
        answer(work, ends[1]);
    }
    close(ends[1]);
    std::string text;
    std::array<char, 65536> buffer{};
    for (;;) {
        const ssize_t count = read(ends[0], buffer.data(), buffer.size());
        if (count < 0 && errno == EINTR) {
            if (interrupted()) kill(child, SIGKILL);
            continue;
        }
        if (count <= 0) break;
        text.append(buffer.data(), static_cast<std::size_t>(count));
    }
    close(ends[0]);
    const int status = wait_for(child);
    throw_if_interrupted();
    if (status != 0 || !Json::accept(text)) return {{"error", why(status, cpu_seconds)}};
    return Json::parse(text);
}

std::string run_program(const std::vector<std::string>& words, double cpu_seconds) {
    throw_if_interrupted();
    std::vector<std::string> copy = words;
    std::vector<char*> arguments;
    for (std::string& word : copy) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    const pid_t child = copy_process();
    if (child == 0) {
        limit_cpu(cpu_seconds);
        limit_memory();
        // What it says of an error would stand in the middle of a progress bar; its code is in the row.
        if (const int nowhere = open("/dev/null", O_WRONLY); nowhere >= 0) {
            dup2(nowhere, STDOUT_FILENO);
            dup2(nowhere, STDERR_FILENO);
        }
        execv(arguments[0], arguments.data());
        _exit(127);
    }
    const int status = wait_for(child);
    throw_if_interrupted();
    return status == 0 ? std::string() : why(status, cpu_seconds);
}

}  // namespace tact::bench
