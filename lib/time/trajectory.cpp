#include "trajectory.hpp"

#include <string>

namespace tact {

Trajectory::Trajectory(const ContactProblem& problem, long steps, Recording recording) : recording_(recording) {
    if (recording.stride < 1)
        throw InputError("Trajectory: stride is " + std::to_string(recording.stride) + ", expected at least 1");
    const Index columns = static_cast<Index>(steps / recording.stride) + (recording.initial ? 1 : 0);
    u_.resize(problem.size(), columns);
    lambda_.resize(recording.multipliers ? problem.constraints() : 0, recording.multipliers ? columns : 0);
    times_.reserve(static_cast<std::size_t>(columns));
    steps_.reserve(static_cast<std::size_t>(columns));
}

Observer Trajectory::observer() {
    return [this](const State& state, const StepReport&) {
        if (state.step == 0 ? !recording_.initial : state.step % recording_.stride != 0) return Flow::proceed;
        const Index j = size();
        if (j == u_.cols()) throw InputError("Trajectory: more states than the steps it was made for");
        u_.col(j) = state.u();
        if (recording_.multipliers) lambda_.col(j) = state.lambda;
        times_.push_back(state.t);
        steps_.push_back(state.step);
        return Flow::proceed;
    };
}

}  // namespace tact
