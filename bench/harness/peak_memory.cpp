#include "peak_memory.hpp"

#include <fstream>
#include <string>

namespace tact::bench {

std::optional<double> peak_memory() {
    std::ifstream status("/proc/self/status");
    for (std::string line; std::getline(status, line);)
        if (line.starts_with("VmHWM:")) return 1024.0 * std::stod(line.substr(6));  // kB
    return std::nullopt;
}

bool reset_peak_memory() {
    std::ofstream clear("/proc/self/clear_refs");
    clear << "5\n";
    return static_cast<bool>(clear.flush());
}

}  // namespace tact::bench
