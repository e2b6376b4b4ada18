#include "moreau_jean.hpp"

#include <utility>

#include "../lib/algebra/row_runs.hpp"
#include "../lib/time/naming.hpp"
#include "hermite.hpp"
#include "impact.hpp"

namespace tact {
namespace {

class MoreauJeanRun final : public Run {
public:
    MoreauJeanRun(const Shared<ContactProblem>& problem, const TimeGrid& grid, const ContactWorkspace& workspace,
                  const MoreauJean::Options& options)
        : owned_(problem),
          grid_(grid),
          theta_(options.theta),
          restitution_(options.restitution),
          stages_(problem, workspace),
          stiffness_(problem->K),
          prepared_(workspace.prepared(*problem, {1, grid.dt * theta_, grid.dt * grid.dt * theta_ * theta_})),
          now_(*problem, grid.t0),
          next_(now_),
          b_(problem->size()),
          work_(problem->size()),
          impulse_(Vector::Zero(problem->constraints())),
          gap_(problem->constraints()),
          bound_(problem->constraints()),
          rate_(Vector::Zero(problem->constraints())),
          scratch_(problem->c.mode_count()) {}

    const State& state() const override { return now_; }
    void dense(double t, State& out) const override { interpolate(next_, now_, t, out); }

    StepReport advance() override {
        const double h = grid_.dt;
        StepReport report{grid_.t(now_.step + 1), now_.step + 1};
        right_side(report.t);
        close_rows(report.t);
        next_.v() = now_.v();
        report.contact = prepared_->solve(b_, bound_, {next_.v(), impulse_});
        report.outcome = report.contact.outcome;
        if (report.outcome != Outcome::converged) return report;
        next_.u() = now_.u() + h * (1 - theta_) * now_.v() + h * theta_ * next_.v();
        next_.lambda = impulse_ / h;
        next_.t = report.t;
        next_.step = report.step;
        std::swap(now_, next_);
        return report;
    }

private:
    /// b_ = M v0 - h (1 - theta) D v0 + h (f_theta - K (u0 + h theta (1 - theta) v0))
    void right_side(double t) {
        const double h = grid_.dt;
        b_ = h * (1 - theta_) * stages_.load(now_.t, Side::right);
        b_ += h * theta_ * stages_.load(t, Side::left);
        problem_.M->multiply(now_.v(), b_, 1, 1);
        work_ = now_.u() + h * theta_ * (1 - theta_) * now_.v();
        stiffness_.add(-h, work_, b_);
        if (problem_.D) problem_.D->multiply(now_.v(), b_, -h * (1 - theta_), 1);
    }

    /// bound_: on v for the rows that close half a step ahead, -infinity for the others
    void close_rows(double t) {
        if (gap_.size() == 0) return;
        const double h = grid_.dt;
        work_ = now_.u() + h / 2 * now_.v();
        problem_.B.multiply(work_, gap_);
        problem_.c.evaluate(now_.t, Side::right, scratch_, bound_);
        if (!problem_.c.constant()) {
            problem_.c.evaluate(t, Side::right, scratch_, rate_);
            rate_ = (rate_ - bound_) / h;
            bound_ += h / 2 * rate_;
        }
        const auto closed = gap_.array() <= bound_.array();
        // An expression of gap_ and bound_: kept before either changes.
        closed_ = closed.cast<double>();
        problem_.B.multiply(now_.v(), gap_);
        bound_ = rate_ - restitution_ * (gap_ - rate_).cwiseMin(0.0);
        for (Index i = 0; i < bound_.size(); ++i)
            if (closed_[i] == 0) bound_[i] = -infinity;
        impulse_ = impulse_.cwiseProduct(closed_);
    }

    Shared<ContactProblem> owned_;
    const ContactProblem& problem_ = *owned_;
    TimeGrid grid_;
    double theta_, restitution_;
    StageSolver stages_;
    RepeatedProduct stiffness_;
    std::shared_ptr<PreparedContact> prepared_;
    State now_, next_;  // after a step next_ is the one before
    Vector b_, work_, impulse_, gap_, bound_, rate_, closed_, scratch_;
};

}  // namespace

MoreauJean::MoreauJean(const Options& options) : options_(options) {
    if (!(options.theta >= 0.5 && options.theta <= 1))
        throw InputError("MoreauJean: theta is " + shown(options.theta) + ", expected from 0.5 to 1");
    check_restitution("MoreauJean", options.restitution);
}

std::string MoreauJean::name() const {
    return WithOptions("moreau-jean").add("theta", options_.theta).add("e", options_.restitution).text();
}

std::unique_ptr<Run> MoreauJean::start(const Shared<ContactProblem>& problem, const TimeGrid& grid,
                                       const ContactWorkspace& workspace) const {
    require_contact_rows("MoreauJean", *problem);
    if (!problem->second_order()) throw InputError("MoreauJean: the problem has no M, expected one");
    if (problem->r) throw InputError("MoreauJean: the problem has an r, expected linear internal forces");
    return std::make_unique<MoreauJeanRun>(problem, grid, workspace, options_);
}

}  // namespace tact
