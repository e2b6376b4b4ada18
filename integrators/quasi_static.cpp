#include "quasi_static.hpp"

#include <utility>

#include "hermite.hpp"

namespace tact {
namespace {

class QuasiStaticRun final : public Run {
public:
    QuasiStaticRun(const Shared<ContactProblem>& problem, const TimeGrid& grid, const ContactWorkspace& workspace)
        : grid_(grid), stages_(problem, workspace), now_(*problem, grid.t0), next_(now_) {}

    const State& state() const override { return now_; }
    void dense(double t, State& out) const override { interpolate(next_, now_, t, out); }

    StepReport advance() override {
        StepReport report{grid_.t(now_.step + 1), now_.step + 1};
        next_.y = now_.y;
        next_.lambda = now_.lambda;
        report.contact = stages_.solve(Stage{report.t, 0, none_, none_}, next_);
        report.outcome = report.contact.outcome;
        if (report.outcome != Outcome::converged) return report;
        next_.step = report.step;
        std::swap(now_, next_);
        return report;
    }

private:
    TimeGrid grid_;
    StageSolver stages_;
    State now_, next_;  // after a step next_ is the one before
    Vector none_;
};

}  // namespace

std::unique_ptr<Run> QuasiStatic::start(const Shared<ContactProblem>& problem, const TimeGrid& grid,
                                        const ContactWorkspace& workspace) const {
    if (!problem->is_static())
        throw InputError("QuasiStatic: the problem has an M or a D, expected neither; use another integrator");
    return std::make_unique<QuasiStaticRun>(problem, grid, workspace);
}

}  // namespace tact
