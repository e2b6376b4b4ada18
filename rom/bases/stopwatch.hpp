// Seconds of training by part.
#pragma once

#include <ctime>

namespace tact {

/// Adds the CPU time that all threads of the process take while it lives to a counter: other processes do not add to it.
class Stopwatch {
public:
    explicit Stopwatch(double& seconds) : seconds_(seconds) {}
    ~Stopwatch() { seconds_ += static_cast<double>(std::clock() - start_) / CLOCKS_PER_SEC; }
    Stopwatch(const Stopwatch&) = delete;
    Stopwatch& operator=(const Stopwatch&) = delete;

private:
    double& seconds_;
    std::clock_t start_ = std::clock();
};

}  // namespace tact
