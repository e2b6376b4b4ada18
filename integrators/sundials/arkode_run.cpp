#include "arkode_run.hpp"

#include <arkode/arkode_arkstep.h>

#include <cmath>
#include <utility>
#include <vector>

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

struct StageData {
    double t = 0, gamma = 0;
    N_Vector predicted = nullptr, known = nullptr;
};

StageData stage_data(void* arkode) {
    StageData data;
    N_Vector z = nullptr, f = nullptr;
    void* user = nullptr;
    check(ARKStepGetNonlinearSystemData(arkode, &data.t, &data.predicted, &z, &f, &data.gamma, &data.known, &user),
          "ARKStepGetNonlinearSystemData");
    return data;
}

class ArkodeRun final : public Run, private StageHook::Client, private LinearHook::Client {
public:
    ArkodeRun(const Shared<ContactProblem>& problem, const TimeGrid& grid, const ContactWorkspace& workspace,
              const ButcherTable& table, const Arkode::Options& options, bool adaptive)
        : owned_(problem),
          grid_(grid),
          workspace_(workspace),
          options_(options),
          adaptive_(adaptive),
          derivative_(problem, workspace),
          stages_(problem, workspace),
          now_(*problem, grid.t0),
          next_(now_),
          before_t_(grid.t0),
          history_(now_.y.size()),
          slope_(now_.y.size()),
          y_(now_.y),
          scratch_(now_.y),
          y_view_(context_, y_),
          scratch_view_(context_, scratch_),
          hook_(context_, stages_, next_, *this),
          linear_(context_, *this),
          table_(table),
          first_implicit_(table.A(0, 0) == 0 ? 1 : 0),
          stage_index_(first_implicit_),
          memory_(ARKStepCreate(nullptr, &ArkodeRun::right_side, grid.t0, y_view_.get(), context_.get())) {
        if (!memory_) throw NumericalError("SUNDIALS: ARKStepCreate failed");
        begin(table);
    }
    ~ArkodeRun() override { ARKStepFree(&memory_); }
    ArkodeRun(const ArkodeRun&) = delete;
    ArkodeRun& operator=(const ArkodeRun&) = delete;

    const State& state() const override { return now_; }
    RunCounters counters() const override { return counters_; }
    void dense(double t, State& out) const override {
        if (!(t >= before_t_ && t <= now_.t))
            throw InputError("Arkode: dense output at t = " + shown(t) + ", expected in the last step");
        if (t == now_.t) {
            out = now_;
            return;
        }
        if (anew_) {  // ARKODE has forgotten the step before
            interpolate(before_, now_, t, out);
            return;
        }
        check(ARKStepGetDky(memory_, t, 0, scratch_view_.get()), "ARKStepGetDky");
        out = now_;
        out.t = t;
        out.y = scratch_;
    }

    StepReport advance() override {
        StepReport report{now_.t, now_.step + 1};
        if (tries_ >= options_.most_steps) {
            report.outcome = Outcome::step_limit;
            return report;
        }
        next_.lambda = now_.lambda;
        double reached = now_.t;
        if (ahead_) begin_anew();
        if (adaptive_) {
            stop_ = next_stop(problem_, now_.t, grid_.t(grid_.steps));
            check(ARKStepSetStopTime(memory_, stop_), "ARKStepSetStopTime");
        }
        const int flag = ARKStepEvolve(memory_, grid_.t(grid_.steps), y_view_.get(), &reached, ARK_ONE_STEP);
        count();
        if (flag < 0) return failed(flag, std::move(report));
        before_t_ = now_.t;
        report.t = adaptive_ ? reached : grid_.t(report.step);
        if (options_.newton) {
            linear_.forget();
            report.contact.strategy = "SUNDIALS' Newton";
            report.contact.kkt = std::exchange(linear_kkt_, {});
            now_.y = y_;
        } else {
            report.contact = hook_.report();
            anew_ = velocity_ && (impulse_.array() > 0).any();
            if (anew_) {
                before_ = now_;
                ahead_ = true;
                report.impact = impact(report.t - now_.t);
                report.outcome = report.impact->outcome;
                if (report.outcome != Outcome::converged) return report;
            }
            // Under contact: the last stage, y_ to rounding, and what was certified.
            now_.y = problem_.constraints() > 0 ? next_.y : y_;
            now_.lambda = next_.lambda;
        }
        now_.t = report.t;
        now_.step = report.step;
        if (anew_) {
            accepted_slope_.resize(0);
            begin_anew();
        } else if (first_implicit_ == 1 && slope_known_) {
            accepted_slope_ = slope_;
        }
        return report;
    }

private:
    /// The step that a stage's gamma = h A_ii belongs to.
    double step_of(double gamma) const { return gamma / table_.A(stage_index_, stage_index_); }

    void begin(const ButcherTable& table) {
        if (options_.restitution && problem_.constraints() > 0) {
            velocity_.emplace(problem_, workspace_, *options_.restitution, false);
            impulse_ = first_lambda_ = Vector::Zero(problem_.constraints());
        }
        void* arkode = memory_;
        check(ARKStepSetErrHandlerFn(arkode, keep_quiet, nullptr), "ARKStepSetErrHandlerFn");
        check(ARKStepSetUserData(arkode, this), "ARKStepSetUserData");
        // SUNDIALS wants rows, ours are columns.
        Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> A = table.A;
        Vector b = table.b, c = table.c, d = table.b_embedded;
        ARKodeButcherTable created =
            ARKodeButcherTable_Create(static_cast<int>(table.stages()), table.order, table.embedded_order, c.data(),
                                      A.data(), b.data(), d.size() > 0 ? d.data() : nullptr);
        if (!created) throw NumericalError("SUNDIALS: ARKodeButcherTable_Create failed");
        const int flag = ARKStepSetTables(arkode, table.order, table.embedded_order, created, nullptr);
        ARKodeButcherTable_Free(created);
        check(flag, "ARKStepSetTables");
        check(ARKStepSetPredictorMethod(arkode, 0), "ARKStepSetPredictorMethod");
        check(ARKStepSetInterpolantType(arkode, ARK_INTERP_LAGRANGE), "ARKStepSetInterpolantType");
        check(ARKStepSetMaxNumSteps(arkode, -1), "ARKStepSetMaxNumSteps");
        check(ARKStepWFtolerances(arkode, &ArkodeRun::weights), "ARKStepWFtolerances");
        if (adaptive_) {
            const double length = grid_.t(grid_.steps) - grid_.t0;
            check(ARKStepSetInitStep(arkode, options_.first_step > 0 ? options_.first_step : 1e-3 * length),
                  "ARKStepSetInitStep");
            if (options_.max_step > 0) check(ARKStepSetMaxStep(arkode, options_.max_step), "ARKStepSetMaxStep");
        } else {
            check(ARKStepSetFixedStep(arkode, grid_.dt), "ARKStepSetFixedStep");
        }
        if (options_.newton) {
            check(ARKStepSetLinearSolver(arkode, linear_.get(), nullptr), "ARKStepSetLinearSolver");
        } else {
            check(ARKStepSetNonlinearSolver(arkode, hook_.get()), "ARKStepSetNonlinearSolver");
            check(ARKStepSetDeduceImplicitRhs(arkode, SUNTRUE), "ARKStepSetDeduceImplicitRhs");
        }
    }

    /// 1 / (rtol |u| + atol), and nothing for v: it jumps at impacts, where any tolerance would fail.
    static int weights(N_Vector y, N_Vector out, void* memory) {
        const auto& run = *static_cast<ArkodeRun*>(memory);
        auto weight = map(out);
        weight.setZero();
        weight.head(run.now_.n) =
            (run.options_.rtol * map(y).head(run.now_.n).array().abs() + run.options_.atol).inverse();
        return 0;
    }

    /// From the state as it is, after a jump of v or a step that was taken back.
    void begin_anew() {
        ahead_ = true;  // until all of this has worked
        y_ = now_.y;
        slope_known_ = false;
        check(ARKStepReset(memory_, now_.t, y_view_.get()), "ARKStepReset");
        ahead_ = false;
    }

    /// next_'s velocity without the impulse of the stages' contact forces, projected.
    ContactReport impact(double h) {
        force_.resize(now_.n);
        next_.lambda = impulse_ / h;  // what closed in any stage
        problem_.M->multiply(next_.v(), force_);
        problem_.B.multiply_transposed(impulse_, force_, -1, 1);
        next_.t = now_.t + h;
        return velocity_->project(now_, force_, h, next_);
    }

    /// z = predicted + known + gamma f(z), so that f = (z - predicted - known) / gamma
    Stage stage() override {
        const StageData data = stage_data(memory_);
        const double a = 1 / data.gamma;
        history_ = -a * (map(data.predicted) + map(data.known));
        predicted_ = data.predicted;
        stage_a_ = a;
        long attempts = 0;
        ARKStepGetNumStepAttempts(memory_, &attempts);
        const bool first = attempts != std::exchange(attempt_, attempts);
        stage_index_ = first ? first_implicit_ : stage_index_ + 1;
        if (first) hook_.begin_step();
        if (first && velocity_)
            impulse_ = (first_implicit_ == 1 ? table_.b[0] * step_of(data.gamma) : 0.0) * first_lambda_;
        next_.y = map(data.predicted);
        const double t = adaptive_ ? before_stop(data.t, stop_) : data.t;
        return {t, a, history_.head(now_.n), history_.tail(history_.size() - now_.n)};
    }
    void correct(N_Vector correction) override {
        map(correction) = next_.y - map(predicted_);
        if (velocity_) impulse_ += table_.b[stage_index_] * step_of(1 / stage_a_) * next_.lambda;
        slope_ = stage_a_ * next_.y + history_;
        slope_known_ = true;
    }

    /// f(t, y) where SUNDIALS asks for it: explicit first stages, and its Newton iteration.
    static int right_side(double t, N_Vector y, N_Vector out, void* memory) {
        auto& run = *static_cast<ArkodeRun*>(memory);
        try {
            auto slope = map(out);
            const auto at = map(y);
            // The step starts from the last stage: its slope, contact forces included, is known; also when the step is
            // tried again and has had other stages since.
            const auto is_at = [&](const State& state) {
                return t == state.t &&
                       (at - state.y).lpNorm<Eigen::Infinity>() <= 1e-12 * state.y.lpNorm<Eigen::Infinity>();
            };
            const bool last = run.slope_known_ && is_at(run.next_);
            if (last || (run.accepted_slope_.size() > 0 && is_at(run.now_))) {
                slope = last ? run.slope_ : run.accepted_slope_;
                run.first_lambda_ = run.now_.lambda;
            } else {
                run.derivative_(t, at, slope);
                run.first_lambda_ = run.derivative_.multipliers();
            }
            return 0;
        } catch (...) {
            run.caught_ = std::current_exception();
            return -1;
        }
    }

    /// (M + g D + g^2 (K + r')) x_v = M b_v - g (K + r') b_u,  x_u = b_u + g x_v;  first order: (D + g K) x = D b
    void solve_linear(N_Vector x_vector, N_Vector b_vector) override {
        ++counters_.stages;
        const ContactProblem& p = problem_;
        const double gamma = stage_data(memory_).gamma;
        const Index n = now_.n;
        const auto b = map(b_vector);
        auto x = map(x_vector);
        force_.resize(n);
        solution_.setZero(n);
        none_.resize(0);
        std::optional<Matrix> tangent;
        if (p.r) tangent = p.r->tangent(map(stage_data(memory_).predicted).head(n));
        Combination combination;
        if (p.second_order()) {
            combination = {1, gamma, gamma * gamma};
            p.M->multiply(b.tail(n), force_);
            p.K.multiply(b.head(n), force_, -gamma, 1);
            if (tangent) tangent->multiply(b.head(n), force_, -gamma, 1);
        } else {
            combination = {0, 1, gamma};
            p.D->multiply(b, force_);
        }
        const auto solve = [&](PreparedContact& prepared) {
            const ContactReport report = prepared.solve(force_, none_, {solution_, none_});
            if (report.outcome != Outcome::converged)
                throw NumericalError("Arkode: the linear solve ended " + std::string(to_string(report.outcome)));
            linear_kkt_.raise_to(report.kkt);
        };
        if (tangent) {
            const Matrix A = combine(combination.stiffness, *tangent, 1, combined(p, combination));
            solve(*workspace_.solver().prepare(A, p.B));
        } else {
            solve(*workspace_.prepared(p, combination));
        }
        if (p.second_order()) {
            x.head(n) = b.head(n) + gamma * solution_;
            x.tail(n) = solution_;
        } else {
            x = solution_;
        }
    }

    void count() {
        long steps = 0, error_failures = 0, stage_failures = 0;
        ARKStepGetNumStepAttempts(memory_, &steps);
        ARKStepGetNumErrTestFails(memory_, &error_failures);
        ARKStepGetNumNonlinSolvConvFails(memory_, &stage_failures);
        tries_ = steps;
        counters_.error_failures = error_failures;
        counters_.stage_failures = stage_failures;
        if (!options_.newton) counters_.stages = hook_.solves();
    }

    StepReport failed(int flag, StepReport report) {
        ahead_ = true;
        if (caught_) std::rethrow_exception(std::exchange(caught_, nullptr));
        hook_.rethrow();
        report.contact = hook_.report();
        if (report.contact.outcome == Outcome::not_finite) {
            report.outcome = Outcome::not_finite;
            return report;
        }
        switch (flag) {
            case ARK_TOO_MUCH_WORK: report.outcome = Outcome::step_limit; break;
            case ARK_TOO_MUCH_ACC: report.outcome = Outcome::tolerance_too_small; break;
            case ARK_ERR_FAILURE:
                report.outcome = Outcome::step_too_small;
                report.detail = "ARKODE: the error test failed repeatedly or at the smallest step";
                break;
            case ARK_CONV_FAILURE:
            case ARK_NLS_OP_ERR:
            case ARK_LSOLVE_FAIL:
                linear_.rethrow();
                report.outcome =
                    report.contact.outcome == Outcome::converged ? Outcome::step_too_small : report.contact.outcome;
                report.detail = "ARKODE: a stage did not converge down to the smallest step";
                break;
            default: throw NumericalError("SUNDIALS: ARKStepEvolve returned " + std::to_string(flag));
        }
        return report;
    }

    Shared<ContactProblem> owned_;
    const ContactProblem& problem_ = *owned_;
    TimeGrid grid_;
    ContactWorkspace workspace_;
    Arkode::Options options_;
    bool adaptive_;
    Context context_;
    Derivative derivative_;
    StageSolver stages_;
    State now_, next_;
    double before_t_;
    double stop_ = infinity;  // of the step under way
    Vector history_, slope_, y_;
    Vector accepted_slope_;  // at now_, where the table's first stage is explicit and it is known
    mutable Vector scratch_;
    Vector force_, solution_, none_;
    VectorView y_view_, scratch_view_;
    StageHook hook_;
    LinearHook linear_;
    N_Vector predicted_ = nullptr;
    double stage_a_ = 0;
    std::optional<VelocityProjection> velocity_;  // with an impact law
    ButcherTable table_;
    Index first_implicit_, stage_index_;
    long attempt_ = -1;
    Vector impulse_;       // h sum b_i lambda_i of the step so far
    Vector first_lambda_;  // of an explicit first stage
    State before_;
    bool anew_ = false;   // the last step ended with a projected velocity, and ARKODE was told
    bool ahead_ = false;  // ARKODE may not be where the state is: a step has failed
    void* memory_;
    bool slope_known_ = false;
    std::exception_ptr caught_;
    KktResiduals linear_kkt_;  // the worst of the step's linear solves
    RunCounters counters_;
    long tries_ = 0;
};

}  // namespace

std::unique_ptr<Run> arkode_run(const Shared<ContactProblem>& problem, const TimeGrid& grid,
                                const ContactWorkspace& workspace, const ButcherTable& table,
                                const Arkode::Options& options, bool adaptive) {
    return std::make_unique<ArkodeRun>(problem, grid, workspace, table, options, adaptive);
}

}  // namespace tact::sundials
