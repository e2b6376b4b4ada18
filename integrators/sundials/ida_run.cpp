#include "ida_run.hpp"

#include <ida/ida.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "../acceleration.hpp"
#include "../hermite.hpp"
#include "../impact.hpp"
#include "check.hpp"
#include "linear_hook.hpp"
#include "stage_hook.hpp"
#include "stops.hpp"
#include "vector.hpp"

namespace tact::sundials {
namespace {

/// IDA's memory, freed before the context and after everything it was handed.
class Memory {
public:
    explicit Memory(const Context& context) : memory_(IDACreate(context.get())) {
        if (!memory_) throw NumericalError("SUNDIALS: IDACreate failed");
    }
    ~Memory() { IDAFree(&memory_); }
    Memory(const Memory&) = delete;
    Memory& operator=(const Memory&) = delete;
    void* get() const { return memory_; }

private:
    void* memory_;
};

struct NonlinearData {
    double t = 0, cj = 0;
    N_Vector y_predicted = nullptr, yp_predicted = nullptr;
};

NonlinearData nonlinear_data(void* ida) {
    NonlinearData data;
    N_Vector y = nullptr, yp = nullptr, residual = nullptr;
    void* user = nullptr;
    check(IDAGetNonlinearSystemData(ida, &data.t, &data.y_predicted, &data.yp_predicted, &y, &yp, &residual, &data.cj,
                                    &user),
          "IDAGetNonlinearSystemData");
    return data;
}

class IdaRun final : public Run, private StageHook::Client, private LinearHook::Client {
public:
    IdaRun(const Shared<ContactProblem>& problem, const TimeGrid& grid, const ContactWorkspace& workspace,
           const Ida::Options& options, bool fixed)
        : owned_(problem),
          grid_(grid),
          workspace_(workspace),
          options_(options),
          fixed_(fixed),
          stages_(problem, workspace),
          now_(*problem, grid.t0),
          next_(now_),
          before_t_(grid.t0),
          history_(now_.y.size()),
          // A clock t^2 beside y: the one component in the error test of fixed steps. Order 1 does not follow it, order 2
          // does exactly, and so IDA stays at order 2.
          y_(now_.y.size() + (fixed ? 1 : 0)),
          yp_(y_.size()),
          id_(Vector::Zero(y_.size())),
          tested_(fixed ? Entries{now_.y.size(), 1} : Entries{0, now_.n}),
          y_view_(context_, y_, tested_),
          yp_view_(context_, yp_),
          answer_view_(context_, y_),
          id_view_(context_, id_),
          hook_(context_, stages_, next_, *this),
          linear_(context_, *this),
          ida_(context_) {
        begin();
    }

    const State& state() const override { return now_; }
    RunCounters counters() const override { return counters_; }
    std::string_view warning() const override {
        const bool risky = options_.max_order > 2 && problem_.constraints() > 0;
        return risky ? "BDF of order above 2 gains energy in impacts" : "";
    }
    void dense(double t, State& out) const override {
        if (!(t >= before_t_ && t <= now_.t))
            throw InputError("Ida: dense output at t = " + shown(t) + ", expected in the last step");
        if (t == now_.t) {
            out = now_;
            return;
        }
        if (anew_) {  // IDA has forgotten the step before
            interpolate(next_, now_, t, out);
            return;
        }
        check(IDAGetDky(ida_.get(), t, 0, scratch_view_->get()), "IDAGetDky");
        out = now_;
        out.t = t;
        out.y = scratch_.head(now_.y.size());
    }

    StepReport advance() override {
        StepReport report{grid_.t(grid_.steps), now_.step + 1};
        const double end = report.t;
        next_.lambda = now_.lambda;
        double reached = now_.t;
        if (options_.most_steps > 0 && tries_ >= options_.most_steps) {
            report.t = now_.t;
            report.outcome = Outcome::step_limit;
            return report;
        }
        if (ahead_) begin_anew();
        if (!fixed_) {
            stop_ = next_stop(problem_, now_.t, end);
            check(IDASetStopTime(ida_.get(), stop_), "IDASetStopTime");
        }
        N_Vector y = options_.newton ? y_view_.get() : answer_view_.get();
        N_Vector yp = options_.newton ? yp_view_.get() : answer_view_.get();
        const int flag = IDASolve(ida_.get(), end, &reached, y, yp, IDA_ONE_STEP);
        count();
        if (flag < 0) return failed(flag, std::move(report));
        before_t_ = now_.t;
        report.t = fixed_ ? grid_.t(report.step) : reached;
        if (options_.newton) {
            now_.y = y_.head(now_.y.size());
            linear_.forget();
            report.contact.strategy = "SUNDIALS' Newton";
            report.contact.kkt = std::exchange(linear_kkt_, {});
        } else {
            report.contact = hook_.report();
            next_.t = report.t;
            anew_ = velocity_ && report.contact.active > 0 && rows_close();
            if (anew_) {
                ahead_ = true;
                report.impact = impact(report.t - now_.t);
                report.outcome = report.impact->outcome;
                if (report.outcome != Outcome::converged) return report;
            }
            std::swap(now_.y, next_.y);  // y_ to rounding, and the very state that was certified
            now_.lambda.swap(next_.lambda);
            next_.t = before_t_;
        }
        now_.t = report.t;
        now_.step = report.step;
        if (anew_) begin_anew();
        return report;
    }

private:
    Index size() const { return now_.y.size(); }

    void begin() {
        if (options_.restitution && problem_.constraints() > 0)
            velocity_.emplace(problem_, workspace_, *options_.restitution, false);
        y_.head(size()) = now_.y;
        Derivative(problem_, workspace_)(grid_.t0, now_.y, yp_.head(size()));
        if (fixed_) {
            y_[size()] = 0;  // the clock runs from t0
            // Not its slope, which is zero: so that the first step corrects the clock by what every later one does, 2 dt^2. Half
            // of that would make IDA's choice of the order after a failed second step a tie, which rounding decides.
            yp_[size()] = -grid_.dt;
        }
        id_.segment(tested_.first, tested_.count).setOnes();
        drop_results(answer_view_.get());
        scratch_ = y_;
        scratch_view_.emplace(context_, scratch_);
        void* ida = ida_.get();
        check(IDASetErrHandlerFn(ida, keep_quiet, nullptr), "IDASetErrHandlerFn");
        check(IDAInit(ida, &IdaRun::residual, grid_.t0, y_view_.get(), yp_view_.get()), "IDAInit");
        check(IDASetUserData(ida, this), "IDASetUserData");
        check(IDAWFtolerances(ida, &IdaRun::weights), "IDAWFtolerances");
        check(IDASetId(ida, id_view_.get()), "IDASetId");
        check(IDASetSuppressAlg(ida, SUNTRUE), "IDASetSuppressAlg");
        check(IDASetMaxOrd(ida, options_.max_order), "IDASetMaxOrd");
        check(IDASetMaxNumSteps(ida, -1), "IDASetMaxNumSteps");
        if (fixed_) {
            check(IDASetInitStep(ida, grid_.dt), "IDASetInitStep");
            check(IDASetMinStep(ida, grid_.dt), "IDASetMinStep");
            check(IDASetMaxStep(ida, grid_.dt), "IDASetMaxStep");
        } else {
            if (options_.first_step > 0) check(IDASetInitStep(ida, options_.first_step), "IDASetInitStep");
            if (options_.max_step > 0) check(IDASetMaxStep(ida, options_.max_step), "IDASetMaxStep");
        }
        if (options_.newton)
            check(IDASetLinearSolver(ida, linear_.get(), nullptr), "IDASetLinearSolver");
        else
            check(IDASetNonlinearSolver(ida, hook_.get()), "IDASetNonlinearSolver");
    }

    /// 1 / (rtol |y| + atol), of all entries for Newton's iteration, else of those in the error test: no other is read.
    static int weights(N_Vector y, N_Vector out, void* memory) {
        const auto& run = *static_cast<IdaRun*>(memory);
        const auto [first, count] = run.options_.newton ? Entries{0, run.y_.size()} : run.tested_;
        // Fixed steps: wide enough for the clock's two steps of order 1, whose error is about dt^2.
        const double rtol = run.fixed_ ? 1e-10 : run.options_.rtol;
        const double atol = run.fixed_ ? 10 * run.grid_.dt * run.grid_.dt : run.options_.atol;
        map(out).segment(first, count) = (rtol * map(y).segment(first, count).array().abs() + atol).inverse();
        return 0;
    }

    bool rows_close() const { return ((next_.lambda.array() > 0) && (now_.lambda.array() <= 0)).any(); }

    /// next_'s velocity without the impulse that the position constraint gave it, projected.
    ContactReport impact(double h) {
        force_.resize(now_.n);
        velocity_->press(next_.lambda, force_);
        velocity_->solve_mass(1 / stage_a_, force_);
        solution_ = next_.v() - force_ / stage_a_;
        problem_.M->multiply(solution_, force_);
        return velocity_->project(now_, force_, h, next_);
    }
    /// From the state as it is, after a jump of v or a step that was taken back: order 1, at the last step's size.
    void begin_anew() {
        ahead_ = true;  // until all of this has worked
        double h = 0;
        IDAGetLastStep(ida_.get(), &h);
        y_ = now_.y;
        Derivative(problem_, workspace_)(now_.t, now_.y, yp_);
        past_ = counters_;
        past_tries_ = tries_;
        check(IDAReInit(ida_.get(), now_.t, y_view_.get(), yp_view_.get()), "IDAReInit");
        ahead_ = false;
        check(IDASetInitStep(ida_.get(), h), "IDASetInitStep");
    }

    Stage stage() override {
        hook_.begin_step();  // one stage a step, or a new attempt at it
        const NonlinearData data = nonlinear_data(ida_.get());
        stage_t_ = fixed_ ? grid_.t(now_.step + 1) : before_stop(data.t, stop_);
        clock_t_ = data.t - grid_.t0;
        predicted_ = noted(data.y_predicted);
        const Sum slope = noted(data.yp_predicted);
        for_each_block(size(), [&](Index first, Index count) {
            auto predicted = block_.head(count);
            auto history = history_.segment(first, count);
            predicted_.evaluate(first, predicted);
            slope.evaluate(first, history);
            history -= data.cj * predicted;
            const Index guessed = std::clamp<Index>(now_.n - first, 0, count);
            next_.y.segment(first, guessed) = predicted.head(guessed);
        });
        // At full size predictions come from memory: from the second stage on they are formed where they are used.
        note_sums(data.y_predicted);
        note_sums(data.yp_predicted);
        stage_a_ = data.cj;
        return {stage_t_, data.cj, history_.head(now_.n), history_.tail(size() - now_.n)};
    }
    void correct(N_Vector correction) override {
        // IDA clears it before a solve and scales it after a step: nobody reads either.
        if (std::exchange(correction_, correction) != correction) drop_results(correction);
        auto change = map(correction);
        for_each_block(change.size(), [&](Index first, Index count) {
            auto predicted = block_.head(count);
            predicted_.evaluate(first, predicted);
            const Index ours = std::min(count, size() - first);
            change.segment(first, ours) = next_.y.segment(first, ours) - predicted.head(ours);
            if (ours < count) change[size()] = clock_t_ * clock_t_ - predicted[ours];
        });
    }

    /// F = (u' - v, M v' + D v + K u + r(u) - f): of Newton's iteration only.
    static int residual(double t, N_Vector y, N_Vector yp, N_Vector out, void* memory) {
        auto& run = *static_cast<IdaRun*>(memory);
        try {
            run.residual(t, map(y), map(yp), map(out));
            return 0;
        } catch (...) {
            run.caught_ = std::current_exception();
            return -1;
        }
    }
    void residual(double t, const Eigen::Map<Vector>& y, const Eigen::Map<Vector>& yp, Eigen::Map<Vector> out) {
        const ContactProblem& p = problem_;
        const Index n = now_.n;
        auto force = out.tail(n);
        force = -stages_.load(t, Side::right);
        p.K.multiply(y.head(n), force, 1, 1);
        if (p.r) {
            force_.resize(n);
            p.r->force(y.head(n), force_);
            force += force_;
        }
        if (!p.second_order()) {
            p.D->multiply(yp, force, 1, 1);
            return;
        }
        if (p.D) p.D->multiply(y.tail(n), force, 1, 1);
        p.M->multiply(yp.tail(n), force, 1, 1);
        out.head(n) = yp.head(n) - y.tail(n);
    }

    /// (cj^2 M + cj D + K) x_u = b_v + (cj M + D) b_u,  x_v = cj x_u - b_u; with r, of K + r'.
    void solve_linear(N_Vector x_vector, N_Vector b_vector) override {
        ++counters_.stages;
        const NonlinearData data = nonlinear_data(ida_.get());
        const ContactProblem& p = problem_;
        const Index n = now_.n;
        const auto b = map(b_vector);
        auto x = map(x_vector);
        force_ = b.tail(n);
        if (p.second_order()) {
            p.M->multiply(b.head(n), force_, data.cj, 1);
            if (p.D) p.D->multiply(b.head(n), force_, 1, 1);
        }
        const Combination combination{data.cj * data.cj, data.cj, 1};
        none_.resize(0);
        solution_.setZero(n);
        const auto solve = [&](PreparedContact& prepared) {
            const ContactReport report = prepared.solve(force_, none_, {solution_, none_});
            if (report.outcome != Outcome::converged)
                throw NumericalError("Ida: the linear solve ended " + std::string(to_string(report.outcome)));
            linear_kkt_.raise_to(report.kkt);
        };
        if (p.r) {
            // At the predictor: a modified Newton iteration.
            const Matrix tangent = p.r->tangent(map(data.y_predicted).head(n));
            solve(*workspace_.solver().prepare(combine(1, tangent, 1, combined(p, combination)), p.B));
        } else {
            solve(*workspace_.prepared(p, combination));
        }
        if (p.second_order()) {
            x.tail(n) = data.cj * solution_ - b.head(n);
            x.head(n) = solution_;
        } else {
            x = solution_;
        }
    }

    void count() {
        long steps = 0, error_failures = 0, stage_failures = 0;
        IDAGetNumSteps(ida_.get(), &steps);
        IDAGetNumErrTestFails(ida_.get(), &error_failures);
        IDAGetNumNonlinSolvConvFails(ida_.get(), &stage_failures);
        tries_ = past_tries_ + steps + error_failures + stage_failures;
        counters_.error_failures = past_.error_failures + error_failures;
        counters_.stage_failures = past_.stage_failures + stage_failures;
        if (!options_.newton) counters_.stages = hook_.solves();
    }

    StepReport failed(int flag, StepReport report) {
        if (caught_) std::rethrow_exception(std::exchange(caught_, nullptr));
        hook_.rethrow();
        report.t = now_.t;
        report.contact = hook_.report();
        if (report.contact.outcome == Outcome::not_finite) {
            report.outcome = Outcome::not_finite;
            return report;
        }
        switch (flag) {
            case IDA_TOO_MUCH_WORK: report.outcome = Outcome::step_limit; break;
            case IDA_TOO_MUCH_ACC: report.outcome = Outcome::tolerance_too_small; break;
            case IDA_ERR_FAIL:
                report.outcome = Outcome::step_too_small;
                report.detail = "IDA: the error test failed repeatedly or at the smallest step";
                break;
            case IDA_CONV_FAIL:
            case IDA_NLS_FAIL:
            case IDA_LSOLVE_FAIL:
                linear_.rethrow();
                report.outcome =
                    report.contact.outcome == Outcome::converged ? Outcome::step_too_small : report.contact.outcome;
                report.detail = "IDA: the stage did not converge down to the smallest step";
                break;
            default: throw NumericalError("SUNDIALS: IDASolve returned " + std::to_string(flag));
        }
        return report;
    }

    Shared<ContactProblem> owned_;
    const ContactProblem& problem_ = *owned_;
    TimeGrid grid_;
    ContactWorkspace workspace_;
    Ida::Options options_;
    bool fixed_;
    Context context_;
    StageSolver stages_;
    State now_, next_;
    double before_t_;
    Vector history_, y_, yp_, id_, force_, solution_, none_;
    Vector block_ = Vector(block_size);
    mutable Vector scratch_;
    Entries tested_;  // of y, in the error test
    VectorView y_view_, yp_view_;
    VectorView answer_view_;  // IDA's own answers are dropped: the stage's is the one that was certified
    VectorView id_view_;
    std::optional<VectorView> scratch_view_;
    StageHook hook_;
    LinearHook linear_;
    Memory ida_;
    std::optional<VelocityProjection> velocity_;  // with an impact law
    bool anew_ = false;                           // the last step ended with a jump of v, and the history began anew
    bool ahead_ = false;                          // IDA is not where the state is: an impact was not resolved
    double stage_t_ = 0, stage_a_ = 0, clock_t_ = 0;
    double stop_ = infinity;  // of the step under way
    Sum predicted_;
    N_Vector correction_ = nullptr;
    std::exception_ptr caught_;
    KktResiduals linear_kkt_;  // the worst of the step's linear solves
    RunCounters counters_, past_;
    long tries_ = 0, past_tries_ = 0;
};

}  // namespace

std::unique_ptr<Run> ida_run(const Shared<ContactProblem>& problem, const TimeGrid& grid,
                             const ContactWorkspace& workspace, const Ida::Options& options, bool fixed) {
    return std::make_unique<IdaRun>(problem, grid, workspace, options, fixed);
}

}  // namespace tact::sundials
