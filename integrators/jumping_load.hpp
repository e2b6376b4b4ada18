// The load on both sides of a step's ends.
#pragma once

#include <algorithm>
#include <cmath>

#include "../lib/time/stage.hpp"

namespace tact {

/// f(t) just before and just after t. Steps whose time is a jump's to rounding end at the jump itself.
class JumpingLoad {
public:
    JumpingLoad(const Shared<ContactProblem>& problem, StageSolver& stages) : owned_(problem), stages_(stages) {}
    const Vector& before(double t, double h) { return stages_.load(near(t, h), Side::left); }
    const Vector& after(double t, double h) { return stages_.load(near(t, h), Side::right); }
    bool jumps(double t, double h) const {
        const auto& jumps = problem_.f.jumps;
        return std::ranges::any_of(jumps, [&](double jump) { return std::abs(jump - t) <= close * h; });
    }

private:
    static constexpr double close = 1e-9;
    double near(double t, double h) const {
        for (const double jump : problem_.f.jumps)
            if (std::abs(jump - t) <= close * h) return jump;
        return t;
    }
    Shared<ContactProblem> owned_;
    const ContactProblem& problem_ = *owned_;
    StageSolver& stages_;
};

}  // namespace tact
