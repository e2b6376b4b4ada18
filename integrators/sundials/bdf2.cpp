#include "bdf2.hpp"

#include <algorithm>
#include <utility>

#include "../hermite.hpp"
#include "stage_hook.hpp"

namespace tact {
namespace {

class Bdf2Run final : public Run, private sundials::StageHook::Client {
public:
    Bdf2Run(const Shared<ContactProblem>& problem, const TimeGrid& grid, const ContactWorkspace& workspace)
        : grid_(grid),
          stages_(problem, workspace),
          now_(*problem, grid.t0),
          next_(now_),
          before_(now_.y),
          history_(Vector::Zero(now_.y.size())),
          hook_(context_, stages_, next_, *this) {}

    const State& state() const override { return now_; }
    void dense(double t, State& out) const override {
        State before = now_;
        before.y = before_;
        before.t = grid_.t(now_.step - 1);
        interpolate(before, now_, t, out);
    }

    StepReport advance() override {
        const long step = now_.step + 1;
        const double dt = grid_.dt;
        if (!open_ || !open_before_) next_.lambda = now_.lambda;  // else both are zero
        // y' = a y + b:  b = -y_n / dt,  or  (y_n-1 - 4 y_n) / (2 dt)
        if (now_.step == 0) {
            a_ = 1 / dt;
            history_ = (-1 / dt) * now_.y;
        } else {
            a_ = 1.5 / dt;
            if (!stages_.reads_guess() || !next_is_earlier_)
                history_ = (-2 / dt) * now_.y + (0.5 / dt) * before_;
            else
                look_back();
        }
        if (stages_.reads_guess() && !next_is_earlier_) next_.u() = now_.u() + dt * now_.v();
        next_is_earlier_ = false;
        t_ = grid_.t(step);
        hook_.begin_step();
        // No predictor and no correction: the stage reads history_ and writes next_.
        SUNNonlinSolSolve(hook_.get(), nullptr, nullptr, nullptr, 0, SUNFALSE, nullptr);
        hook_.rethrow();
        const StepReport report{t_, step, hook_.report().outcome, hook_.report(), {}, {}};
        if (report.outcome != Outcome::converged) return report;
        next_.step = step;
        // n-1 <- n <- n+1
        before_.swap(now_.y);
        now_.y.swap(next_.y);
        now_.lambda.swap(next_.lambda);
        now_.t = next_.t;
        now_.step = step;
        next_is_earlier_ = step >= 2;
        open_before_ = open_;
        open_ = report.contact.active == 0 && report.contact.kkt.absolute.negativity == 0;
        return report;
    }

private:
    Stage stage() override { return {t_, a_, history_.head(now_.n), history_.tail(history_.size() - now_.n)}; }
    void correct(N_Vector) override {}

    /// The history b, and a guess by quadratic extrapolation in time for an iterative solver, both in one pass: at full
    /// size the states come from memory. On entry `next_` holds y_n-2.
    void look_back() {
        constexpr Index block = 1024;
        const double dt = grid_.dt;
        for (Index first = 0; first < before_.size(); first += block) {
            const Index count = std::min(block, before_.size() - first);
            const auto now = now_.y.segment(first, count), before = before_.segment(first, count);
            auto next = next_.y.segment(first, count);
            history_.segment(first, count) = (-2 / dt) * now + (0.5 / dt) * before;
            if (first < now_.n) next = 3 * (now - before) + next;
        }
    }

    TimeGrid grid_;
    sundials::Context context_;
    StageSolver stages_;
    State now_, next_;
    Vector before_, history_;
    sundials::StageHook hook_;
    double t_ = 0;
    double a_ = 0;
    bool open_ = true, open_before_ = true;  // no multipliers at `now_`, nor at the step before it
    bool next_is_earlier_ = false;           // the storage of `next_` still holds y_n-2
};

}  // namespace

std::unique_ptr<Run> Bdf2::start(const Shared<ContactProblem>& problem, const TimeGrid& grid,
                                 const ContactWorkspace& workspace) const {
    if (problem->is_static())
        throw InputError("Bdf2: the problem has neither M nor D, expected one; use solve_static");
    if (problem->u0.size() != problem->size())
        throw InputError("Bdf2: u0 is " + std::to_string(problem->u0.size()) + "x1, expected " +
                         std::to_string(problem->size()) + "x1");
    return std::make_unique<Bdf2Run>(problem, grid, workspace);
}

}  // namespace tact
