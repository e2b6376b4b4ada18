#include "errors.hpp"

#include <array>
#include <charconv>

namespace tact {

std::string_view to_string(Outcome outcome) {
    switch (outcome) {
        case Outcome::converged: return "converged";
        case Outcome::iteration_limit: return "iteration limit";
        case Outcome::cycling: return "cycling";
        case Outcome::infeasible: return "infeasible";
        case Outcome::unbounded: return "unbounded";
        case Outcome::inaccurate: return "inaccurate";
        case Outcome::step_limit: return "step limit";
        case Outcome::step_too_small: return "step too small";
        case Outcome::tolerance_too_small: return "tolerance too small";
        case Outcome::not_finite: return "not finite";
        case Outcome::stopped: return "stopped";
    }
    return "unknown";
}

std::string shown(double number) {
    std::array<char, 32> digits;  // the longest is -2.2250738585072014e-308
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), number).ptr;
    return {digits.data(), end};
}

}  // namespace tact
