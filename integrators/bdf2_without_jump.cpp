#include "bdf2_without_jump.hpp"

#include <utility>

#include "../lib/time/naming.hpp"
#include "hermite.hpp"
#include "impact.hpp"

namespace tact {
namespace {

class WithoutJumpRun final : public Run {
public:
    WithoutJumpRun(const Shared<ContactProblem>& problem, const TimeGrid& grid, const ContactWorkspace& workspace,
                   double restitution)
        : owned_(problem),
          grid_(grid),
          stages_(problem, workspace),
          velocity_(problem, workspace, restitution, false),
          watches_energy_(problem->c.constant()),
          now_(*problem, grid.t0),
          next_(now_),
          before_(now_.y),
          history_(now_.y.size()),
          impulse_(problem->size()),
          momentum_(problem->size()),
          free_(problem->size()),
          closing_(Vector::Zero(problem->constraints())) {}

    const State& state() const override { return now_; }
    void dense(double t, State& out) const override { interpolate(next_, now_, t, out); }

    StepReport advance() override {
        const double h = grid_.dt;
        const bool first = now_.step == 0;
        const double a = first ? 1 / h : 1.5 / h;
        if (first)
            history_ = now_.y / -h;
        else
            history_ = -2 / h * now_.y + 0.5 / h * before_;
        guess();
        StepReport report = attempt(a);
        if (report.outcome != Outcome::converged) return report;
        if (watches_energy_ && (report.impact || watched_ > 0)) {
            double surplus = surplus_ + velocity_.excess_energy(now_, next_);
            if (surplus > rounding * kinetic_energy() && !first) {
                theta_history();
                report = attempt(a);
                if (report.outcome != Outcome::converged) return report;
                surplus = surplus_ + velocity_.excess_energy(now_, next_);
            }
            watched_ = report.impact ? free_steps_watched : watched_ - 1;
            surplus_ = watched_ > 0 ? surplus : 0;
        }
        next_.step = report.step;
        std::swap(now_, next_);
        before_.swap(coming_);
        return report;
    }

private:
    /// Of the kinetic energy: what the balance itself rounds to.
    static constexpr double rounding = 1e-10;
    /// Steps after one that ended in contact whose energy is looked at.
    static constexpr int free_steps_watched = 2;

    /// From history_ to next_ and coming_.
    StepReport attempt(double a) {
        StepReport report{grid_.t(now_.step + 1), now_.step + 1};
        const Index n = now_.n;
        next_.lambda = closing_;
        report.contact = stages_.solve(Stage{report.t, a, history_.head(n), history_.tail(n)}, next_);
        report.outcome = report.contact.outcome;
        if (report.outcome != Outcome::converged) return report;
        closing_ = next_.lambda;
        coming_ = now_.y;
        if (report.contact.active > 0) {
            report.impact = impact(a);
            report.outcome = report.impact->outcome;
        }
        return report;
    }

    /// The theta-method with theta = 2/3 has BDF2's a = 3/(2h): y' = a y1 - 3/(2h) y0 - y0'/2 with the same matrix, and
    /// loses energy at any h where BDF2 may gain some from the history of an impact. y0' without contact forces: those of
    /// the step's beginning would do work on rows that open.
    void theta_history() {
        const Index n = now_.n;
        force_ = stages_.load(now_.t, Side::right);
        problem_.K.multiply(now_.u(), force_, -1, 1);
        if (problem_.r) {
            problem_.r->force(now_.u(), momentum_);
            force_ -= momentum_;
        }
        if (problem_.D) problem_.D->multiply(now_.v(), force_, -1, 1);
        velocity_.solve_mass(0, force_);
        history_ = -1.5 / grid_.dt * now_.y;
        history_.head(n) -= 0.5 * now_.v();
        history_.tail(n) -= 0.5 * force_;
    }

    double kinetic_energy() {
        problem_.M->multiply(next_.v(), momentum_);
        return 0.5 * next_.v().dot(momentum_);
    }

    /// From next_ = (u1, v_BDF2, nu) to (u1, v1, P/h), and coming_ to the history of the next step.
    ContactReport impact(double a) {
        const double h = grid_.dt;
        const Index n = now_.n;
        velocity_.press(next_.lambda, impulse_);
        momentum_ = impulse_;
        velocity_.solve_mass(1 / a, momentum_);
        free_ = next_.v() - momentum_ / a;  // w
        if (problem_.D) velocity_.solve_mass(0, impulse_);
        const Vector& shift = problem_.D ? impulse_ : momentum_;  // M^-1 B' nu
        coming_.head(n) += shift / (a * a);
        problem_.M->multiply(free_, momentum_);
        const ContactReport report = velocity_.project(now_, momentum_, h, next_);
        if (report.outcome != Outcome::converged) return report;
        free_ = next_.v() - free_;  // d_v
        coming_.head(n) -= h * free_;
        coming_.tail(n) += free_;
        return report;
    }

    /// Extrapolation in time: what an iterative solver starts from.
    void guess() {
        if (!stages_.reads_guess() && !problem_.r) return;
        older_ = next_.u();
        if (now_.step >= 2 && oldest_.size() > 0)  // what solved the first step may have read no guess
            next_.u() = 3 * now_.u() - 3 * older_ + oldest_;
        else
            next_.u() = now_.u() + grid_.dt * now_.v();
        oldest_ = older_;
    }

    Shared<ContactProblem> owned_;
    const ContactProblem& problem_ = *owned_;
    TimeGrid grid_;
    StageSolver stages_;
    VelocityProjection velocity_;
    bool watches_energy_;
    int watched_ = 0;     // steps that will be looked at
    double surplus_ = 0;  // energy gained since the first step of this contact, less the work of the load
    State now_, next_;    // after a step next_ is the one before
    Vector before_;       // (ub, vb)
    Vector coming_;       // those of the step after this one
    Vector history_, impulse_, momentum_, free_, older_, oldest_, force_;
    Vector closing_;  // position multipliers of the last step
};

}  // namespace

Bdf2WithoutJump::Bdf2WithoutJump(double restitution) : restitution_(restitution) {
    check_restitution("Bdf2WithoutJump", restitution);
}

std::string Bdf2WithoutJump::name() const { return WithOptions("bdf2-without-jump").add("e", restitution_).text(); }

std::unique_ptr<Run> Bdf2WithoutJump::start(const Shared<ContactProblem>& problem, const TimeGrid& grid,
                                            const ContactWorkspace& workspace) const {
    if (!problem->second_order()) throw InputError("Bdf2WithoutJump: the problem has no M, expected one; use Bdf2");
    return std::make_unique<WithoutJumpRun>(problem, grid, workspace, restitution_);
}

}  // namespace tact
