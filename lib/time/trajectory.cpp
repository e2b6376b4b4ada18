#include "trajectory.hpp"

#include <string>

namespace tact {

Trajectory::Trajectory(const ContactProblem& problem, long steps, Recording recording)
    : record_(std::make_shared<Record>(Record{recording})) {
    if (recording.stride < 1)
        throw InputError("Trajectory: stride is " + std::to_string(recording.stride) + ", expected at least 1");
    const Index columns = static_cast<Index>(steps / recording.stride) + (recording.initial ? 1 : 0);
    record_->u.resize(problem.size(), columns);
    record_->lambda.resize(recording.multipliers ? problem.constraints() : 0, recording.multipliers ? columns : 0);
    record_->times.reserve(static_cast<std::size_t>(columns));
    record_->steps.reserve(static_cast<std::size_t>(columns));
}

Observer Trajectory::observer() const {
    return [record = record_](const State& state, const StepReport&) {
        const Recording& recording = record->recording;
        if (state.step == 0 ? !recording.initial : state.step % recording.stride != 0) return Flow::proceed;
        const Index j = static_cast<Index>(record->times.size());
        if (j == record->u.cols()) throw InputError("Trajectory: more states than the steps it was made for");
        record->u.col(j) = state.u();
        if (recording.multipliers) record->lambda.col(j) = state.lambda;
        record->times.push_back(state.t);
        record->steps.push_back(state.step);
        return Flow::proceed;
    };
}

}  // namespace tact
