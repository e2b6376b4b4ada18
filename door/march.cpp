#include "march.hpp"

#include <algorithm>
#include <ostream>
#include <string>

#include "../contact/automatic.hpp"
#include "../integrators/quasi_static.hpp"
#include "../integrators/trapezoid.hpp"

namespace tact {
namespace {

Shared<Integrator> usual_integrator(const ContactProblem& problem) {
    if (problem.is_static()) return QuasiStatic();
    return Trapezoid();
}

/// Writes the states into the rows of a March.
class Recorder {
public:
    Recorder(const ContactProblem& problem, const Scheme& scheme, const Keep& keep, March& march)
        : keep_(keep), march_(march) {
        if (keep.stride < 0)
            throw InputError("Keep: stride is " + std::to_string(keep.stride) + ", expected at least 0");
        for (const long step : keep.steps)
            if (step < 0) throw InputError("Keep: steps holds " + std::to_string(step) + ", expected none below 0");
        std::ranges::sort(keep_.steps);
        const auto [repeated, end] = std::ranges::unique(keep_.steps);
        keep_.steps.erase(repeated, end);
        march.u.resize(0, keep.u ? problem.size() : 0);
        march.v.resize(0, keep.v && problem.second_order() ? problem.size() : 0);
        march.lambda.resize(0, keep.lambda ? problem.constraints() : 0);
        // An adaptive integrator takes as many steps as it likes: room is then made as it goes.
        if (!scheme.integrator->adaptive()) make_room(expected(scheme.grid));
    }

    void add(const State& state) {
        if (!kept(state.step)) return;
        const Index row = static_cast<Index>(march_.steps.size());
        if (row == room_) make_room(std::max<Index>(2 * room_, 16));
        march_.times[row] = state.t;
        march_.steps.push_back(state.step);
        if (march_.u.cols() > 0) march_.u.row(row) = state.u();
        if (march_.v.cols() > 0) march_.v.row(row) = state.v();
        if (march_.lambda.cols() > 0) march_.lambda.row(row) = state.lambda;
    }

    /// Gives back the room that was not needed.
    void finish() { make_room(static_cast<Index>(march_.steps.size())); }

private:
    bool kept(long step) const {
        if (step == 0 ? keep_.initial : keep_.stride > 0 && step % keep_.stride == 0) return true;
        return std::ranges::binary_search(keep_.steps, step);
    }
    Index expected(const TimeGrid& grid) const {
        Index count = keep_.initial ? 1 : 0;
        if (keep_.stride > 0 && grid.steps > 0) count += grid.steps / keep_.stride;
        for (const long step : keep_.steps)
            if (step <= grid.steps && (step == 0 ? !keep_.initial : keep_.stride == 0 || step % keep_.stride != 0))
                ++count;
        return count;
    }
    void make_room(Index rows) {
        if (rows == room_) return;
        march_.times.conservativeResize(rows);
        march_.steps.reserve(static_cast<std::size_t>(rows));
        for (History* history : {&march_.u, &march_.v, &march_.lambda})
            history->conservativeResize(rows, Eigen::NoChange);
        room_ = rows;
    }

    Keep keep_;
    March& march_;
    Index room_ = 0;
};

}  // namespace

March march(const ContactProblem& problem, const Scheme& given, const MarchSettings& settings) {
    validate(problem);
    Scheme scheme = given;
    if (!scheme.integrator) scheme.integrator = usual_integrator(problem);
    if (!scheme.contact) scheme.contact = AutomaticContact();
    March march;
    Recorder recorder(problem, scheme, settings.keep, march);
    std::vector<Observer> observers{[&recorder](const State& state, const StepReport&) {
        recorder.add(state);
        return Flow::proceed;
    }};
    observers.insert(observers.end(), settings.observers.begin(), settings.observers.end());
    march.report = integrate(*scheme.integrator, problem, scheme.grid, ContactWorkspace(scheme.contact), observers,
                             {settings.initial_penetration});
    recorder.finish();
    return march;
}

std::ostream& operator<<(std::ostream& out, const March& march) {
    return out << "march of " << march.steps.size() << " kept states, " << march.report;
}

}  // namespace tact
