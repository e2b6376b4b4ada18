#include "trapezoid.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "../lib/algebra/row_runs.hpp"
#include "../lib/time/naming.hpp"
#include "hermite.hpp"
#include "impact.hpp"
#include "jumping_load.hpp"

namespace tact {
namespace {

/// Chung and Hulbert's coefficients; rho = 1: 1/2, 1/2, 1/2, 1/4.
struct Alpha {
    explicit Alpha(double rho)
        : m((2 * rho - 1) / (rho + 1)),
          f(rho / (rho + 1)),
          gamma(0.5 - m + f),
          beta((gamma + 0.5) * (gamma + 0.5) / 4) {}
    double m, f, gamma, beta;
};

/// What the two orders in time share: states, guesses, K u + r(u).
class TrapezoidRun : public Run {
public:
    TrapezoidRun(const Shared<ContactProblem>& problem, const TimeGrid& grid, const ContactWorkspace& workspace)
        : owned_(problem),
          grid_(grid),
          stages_(problem, workspace),
          load_(problem, stages_),
          stiffness_(problem->K),
          now_(*problem, grid.t0),
          next_(now_),
          rhs_(problem->size()),
          internal_(problem->size()),
          work_(problem->size()),
          force_(problem->size()),
          closing_(Vector::Zero(problem->constraints())) {}

    const State& state() const override { return now_; }
    void dense(double t, State& out) const override { interpolate(next_, now_, t, out); }

protected:
    /// internal_ = K u + r(u)
    void internal_forces(const ConstVectorRef& u) {
        internal_.setZero();
        stiffness_.add(1, u, internal_);
        if (!problem_.r) return;
        problem_.r->force(u, work_);
        internal_ += work_;
    }
    /// Extrapolation in time, quadratic as soon as there are three states: what an iterative solver starts from.
    void guess() {
        if (now_.step >= 2)
            next_.u() = 3 * now_.u() - 3 * next_.u() + earlier_;
        else if (problem_.second_order())
            next_.u() = now_.u() + grid_.dt * now_.v();
        else
            next_.u() = now_.u();
    }
    /// The step's solve for u, into next_.
    ContactReport solve_position(const Combination& combination, double t) {
        if (stages_.reads_guess() || problem_.r) {
            work_ = next_.u();
            guess();
            earlier_ = work_;
        } else {
            next_.u() = now_.u();
        }
        next_.lambda = closing_;
        return stages_.solve(combination, t, rhs_, {next_.u(), next_.lambda});
    }
    StepReport accept(StepReport report) {
        next_.t = report.t;
        next_.step = report.step;
        std::swap(now_, next_);
        return report;
    }

    Shared<ContactProblem> owned_;
    const ContactProblem& problem_ = *owned_;
    TimeGrid grid_;
    StageSolver stages_;
    JumpingLoad load_;
    RepeatedProduct stiffness_;
    State now_, next_;  // after a step next_ is the one before
    Vector rhs_, internal_, work_, earlier_;
    Vector force_;    // f - K u - D v at the end of the last step, right limit
    Vector closing_;  // position multipliers of the last step
};

class SecondOrderRun final : public TrapezoidRun {
public:
    SecondOrderRun(const Shared<ContactProblem>& problem, const TimeGrid& grid, const ContactWorkspace& workspace,
                   const Trapezoid::Options& options)
        : TrapezoidRun(problem, grid, workspace),
          damped_(options.rho < 1),
          alpha_(options.rho),
          velocity_(problem, workspace, options.restitution, !damped_ && !problem->r),
          momentum_(problem->size()) {
        const double h = grid.dt;
        combination_ = {(1 - alpha_.m) / ((1 - alpha_.f) * h * h * alpha_.beta), alpha_.gamma / (h * alpha_.beta), 1};
    }

    StepReport advance() override {
        if (now_.step == 0) begin();
        const double h = grid_.dt;
        StepReport report{grid_.t(now_.step + 1), now_.step + 1};
        end_load_ = load_.before(report.t, h);
        position_side();
        report.contact = solve_position(combination_, report.t);
        report.outcome = report.contact.outcome;
        if (report.outcome != Outcome::converged) return report;
        closing_ = next_.lambda;
        next_.t = report.t;

        internal_forces(next_.u());
        internal_ = end_load_ - internal_;  // f1 - K u1
        velocity_side();
        const ContactReport impact = velocity_.project(now_, momentum_, h, next_);
        if (report.contact.active > 0) report.impact = impact;
        report.outcome = impact.outcome;
        if (report.outcome != Outcome::converged) return report;
        end_forces(report.t);
        return accept(std::move(report));
    }

private:
    const Vector& acceleration_force() const { return damped_ ? algorithmic_ : force_; }

    void begin() {
        internal_forces(now_.u());
        force_ = load_.after(grid_.t0, grid_.dt) - internal_;
        if (problem_.D) problem_.D->multiply(now_.v(), force_, -1, 1);
        if (damped_) algorithmic_ = force_;
    }

    /// rhs_ = f1 + m M q + d D q - D (v0 + h (1 - gamma) a0) + (af k0 - am a0) / (1 - af), k and a times M,
    /// q = u0 + h v0 + h^2 (1/2 - beta) a0
    void position_side() {
        const double h = grid_.dt;
        const Vector& a0 = acceleration_force();
        work_ = now_.u() + h * now_.v();
        rhs_ = end_load_;
        problem_.M->multiply(work_, rhs_, combination_.mass, 1);
        rhs_ += (combination_.mass * h * h * (0.5 - alpha_.beta) - alpha_.m / (1 - alpha_.f)) * a0 +
                alpha_.f / (1 - alpha_.f) * force_;
        if (!problem_.D) return;
        work_ = combination_.damping * work_ - now_.v();
        if (damped_) {
            momentum_ = a0;
            velocity_.solve_mass(0, momentum_);
            work_ += h * (alpha_.gamma / (2 * alpha_.beta) - 1) * momentum_;
        }
        problem_.D->multiply(work_, rhs_, 1, 1);
    }

    /// momentum_ = M w, from internal_ = f1 - K u1
    void velocity_side() {
        const double h = grid_.dt;
        const Vector& a0 = acceleration_force();
        const double share = h * alpha_.gamma / (1 - alpha_.m);
        momentum_ = share * (1 - alpha_.f) * internal_ + share * alpha_.f * force_ +
                    (h * (1 - alpha_.gamma) - share * alpha_.m) * a0;
        problem_.M->multiply(now_.v(), momentum_, 1, 1);
        if (!problem_.D) return;
        velocity_.solve_mass(share * (1 - alpha_.f), momentum_);
        work_ = momentum_;
        problem_.M->multiply(work_, momentum_);
    }

    void end_forces(double t) {
        if (problem_.D) problem_.D->multiply(next_.v(), internal_, -1, 1);
        if (damped_) {
            algorithmic_ =
                ((1 - alpha_.f) * internal_ + alpha_.f * force_ - alpha_.m * algorithmic_) / (1 - alpha_.m);
        }
        force_ = internal_;
        if (!load_.jumps(t, grid_.dt)) return;
        work_ = load_.after(t, grid_.dt) - end_load_;
        force_ += work_;
        if (damped_) algorithmic_ += work_;
    }

    bool damped_;
    Alpha alpha_;
    VelocityProjection velocity_;
    Combination combination_;
    Vector end_load_;  // f1, left limit
    Vector momentum_;
    Vector algorithmic_;  // M a of the family's own acceleration; rho = 1: force_ itself
};

/// Crank-Nicolson: (2/h D + K) u1 = 2/h D u0 + f0 - K u0 + f1 + 2 B' lambda.
class FirstOrderRun final : public TrapezoidRun {
public:
    using TrapezoidRun::TrapezoidRun;

    StepReport advance() override {
        const double h = grid_.dt;
        StepReport report{grid_.t(now_.step + 1), now_.step + 1};
        internal_forces(now_.u());
        rhs_ = load_.after(now_.t, h) - internal_;
        rhs_ += load_.before(report.t, h);
        problem_.D->multiply(now_.u(), rhs_, 2 / h, 1);
        closing_ = 2 * now_.lambda;
        report.contact = solve_position({0, 2 / h, 1}, report.t);
        report.outcome = report.contact.outcome;
        if (report.outcome != Outcome::converged) return report;
        next_.lambda *= 0.5;
        return accept(std::move(report));
    }
};

}  // namespace

Trapezoid::Trapezoid(const Options& options) : options_(options) {
    if (!(options.rho >= 0 && options.rho <= 1))
        throw InputError("Trapezoid: rho is " + shown(options.rho) + ", expected from 0 to 1");
    check_restitution("Trapezoid", options.restitution);
}

std::string Trapezoid::name() const {
    return WithOptions("trapezoid").add_unless(1, "rho", options_.rho).add("e", options_.restitution).text();
}

std::unique_ptr<Run> Trapezoid::start(const Shared<ContactProblem>& problem, const TimeGrid& grid,
                                      const ContactWorkspace& workspace) const {
    if (problem->is_static())
        throw InputError("Trapezoid: the problem has neither M nor D, expected one; use QuasiStatic");
    if (problem->second_order()) return std::make_unique<SecondOrderRun>(problem, grid, workspace, options_);
    if (options_.rho < 1)
        throw InputError("Trapezoid: rho is " + shown(options_.rho) + " on a problem of first order, expected 1");
    return std::make_unique<FirstOrderRun>(problem, grid, workspace);
}

}  // namespace tact
