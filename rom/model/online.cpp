#include "online.hpp"

#include <algorithm>
#include <atomic>
#include <exception>
#include <thread>

#include "../../lib/time/naming.hpp"

namespace tact {

/// One thread's solver: workspaces that keep their factors from query to query.
class Online::Worker {
public:
    Worker(const Shared<ReducedModel>& model, const OnlineMethod& method, const OnlineOptions& options)
        : owned_(model), method_(method), options_(options), workspace_(method_.contact), check_(model) {}

    Answer solve(const Parameter& gamma) {
        Answer answer;
        try {
            reduced(gamma, answer);
        } catch (const NumericalError& error) {
            fail(answer, error);
        } catch (const InputError& error) {
            fail(answer, error);
        }
        Trust& trust = answer.trust;
        trust.outside_box = !model_.covers(gamma);
        const double tolerance = model_.data().checks.tolerance;
        trust.doubtful = trust.outside_box || (trust.estimate && !(*trust.estimate <= tolerance));
        if (options_.fall_back && (trust.doubtful || answer.outcome != Outcome::converged)) full(gamma, answer);
        return answer;
    }

private:
    static void fail(Answer& answer, const std::exception& error) {
        answer.outcome = Outcome::inaccurate;
        answer.failure = error.what();
    }

    bool kept(const State& state) const {
        return state.step % options_.stride == 0 || state.step == model_.data().method.grid.steps;
    }

    void reduced(const Parameter& gamma, Answer& answer) {
        const ReducedQuantities& quantities = model_.data().quantities;
        const Shared<ContactProblem> shared = model_.at(gamma);
        const ContactProblem& problem = *shared;
        check_.begin(gamma, shared);
        Index count = 0;
        const Index most = method_.integrator ? model_.data().method.grid.steps / options_.stride + 2 : 1;
        answer.quantities.resize(quantities.Q.rows(), most);
        if (options_.keep_states) {
            answer.q.resize(problem.size(), most);
            answer.s.resize(problem.constraints(), most);
        }
        const auto record = [&](const State& state) {
            check_.add(state);
            if (!kept(state)) return;
            grow(answer.quantities, count);
            auto column = answer.quantities.col(count);
            column.noalias() = quantities.Q * state.u();
            column.noalias() += quantities.Q_lambda * state.lambda;
            if (options_.keep_states) {
                grow(answer.q, count);
                grow(answer.s, count);
                answer.q.col(count) = state.u();
                answer.s.col(count) = state.lambda;
            }
            answer.times.push_back(state.t);
            ++count;
        };
        run(problem, workspace_, answer, answer.state, record);
        answer.quantities.conservativeResize(Eigen::NoChange, count);
        if (options_.keep_states) {
            answer.q.conservativeResize(Eigen::NoChange, count);
            answer.s.conservativeResize(Eigen::NoChange, count);
        }
        answer.trust.penetration = check_.penetration();
        answer.trust.residual = check_.residual();
        answer.trust.estimate = check_.estimate();
    }

    void full(const Parameter& gamma, Answer& answer) {
        const FullModel& fall_back = *options_.fall_back;
        if (!full_workspace_) full_workspace_.emplace(fall_back.contact);
        answer.outcome = Outcome::converged;
        answer.failure.clear();
        answer.failed_step = 0;
        answer.times.clear();
        answer.quantities.resize(static_cast<Index>(fall_back.quantities.size()), 1);
        Index count = 0;
        const auto record = [&](const State& state) {
            if (!kept(state)) return;
            grow(answer.quantities, count);
            for (std::size_t k = 0; k < fall_back.quantities.size(); ++k) {
                const QuantityOfInterest& of = fall_back.quantities[k];
                double value = 0;
                if (of.displacement.size() > 0) value += of.displacement.dot(state.u());
                if (of.force.size() > 0) value += of.force.dot(state.lambda);
                answer.quantities(static_cast<Index>(k), count) = value;
            }
            answer.times.push_back(state.t);
            ++count;
        };
        answer.full.emplace();
        try {
            run(fall_back.family->at(gamma), *full_workspace_, answer, *answer.full, record);
        } catch (const NumericalError& error) {
            fail(answer, error);
        } catch (const InputError& error) {
            fail(answer, error);
        }
        answer.quantities.conservativeResize(Eigen::NoChange, count);
    }

    /// Adaptive integrators take more steps than the grid has.
    static void grow(DenseMatrix& columns, Index needed) {
        if (columns.cols() <= needed) columns.conservativeResize(Eigen::NoChange, 2 * needed + 1);
    }

    template <class Record>
    void run(const ContactProblem& problem, const ContactWorkspace& workspace, Answer& answer, State& state,
             const Record& record) const {
        if (method_.integrator) {
            const Observer observer = [&](const State& at, const StepReport&) {
                record(at);
                return Flow::proceed;
            };
            // A reduced start may penetrate: it is a projection.
            MarchReport march = integrate(*method_.integrator, problem, model_.data().method.grid, workspace,
                                          {&observer, 1}, {InitialPenetration::accept});
            answer.outcome = march.outcome;
            answer.kkt = march.worst_kkt;
            if (march.outcome != Outcome::converged) answer.failed_step = march.last.step;
            state = std::move(march.final_state);
            return;
        }
        StaticSolution solution = solve_static(problem, workspace);
        answer.outcome = solution.report.outcome;
        answer.kkt = solution.report.kkt;
        state.n = problem.size();
        state.y = std::move(solution.u);
        state.lambda = std::move(solution.lambda);
        if (answer.outcome == Outcome::converged) record(state);
    }

    Shared<ReducedModel> owned_;
    const ReducedModel& model_ = *owned_;
    const OnlineMethod& method_;
    const OnlineOptions& options_;
    ContactWorkspace workspace_;
    std::optional<ContactWorkspace> full_workspace_;
    ErrorCheck check_;
};

OnlineMethod online_method(const ReducedModel& model, const Registry& registry) {
    const ReducedMethod& trained = model.data().method;
    const WithOptions dense = WithOptions("dense")
                                  .add_unless(0, "compliance", trained.compliance)
                                  .add_unless(1, "screening", trained.screening ? 1 : 0);
    OnlineMethod method{registry.contact(dense.text()), nullptr};
    if (!trained.integrator.empty()) method.integrator = registry.integrator(trained.integrator);
    return method;
}

Online::Online(std::shared_ptr<const ReducedModel> model, OnlineMethod method, OnlineOptions options)
    : model_(std::move(model)), method_(std::move(method)), options_(std::move(options)) {
    if (!model_ || !method_.contact) throw InputError("Online: the model or the contact solver is null");
    const std::string& trained = model_->data().method.integrator;
    const std::string given = method_.integrator ? method_.integrator->name() : "";
    if (given != trained)
        throw InputError("Online: the integrator is \"" + given + "\", expected the model's \"" + trained + "\"");
    if (options_.stride < 1)
        throw InputError("OnlineOptions: stride is " + std::to_string(options_.stride) + ", expected at least 1");
    if (options_.fall_back) {
        const FullModel& full = *options_.fall_back;
        if (!full.family || !full.contact) throw InputError("FullModel: the family or the contact solver is null");
        if (full.quantities.size() != model_->data().quantities.names.size())
            throw InputError("FullModel: there are " + std::to_string(full.quantities.size()) +
                             " quantities, expected the model's " +
                             std::to_string(model_->data().quantities.names.size()));
    }
    worker_ = std::make_unique<Worker>(model_, method_, options_);
}

Online::~Online() = default;

void Online::check(const Parameter& gamma, const std::string& name) const {
    const Index expected = model_->data().lower.size();
    if (gamma.size() != expected || !gamma.allFinite())
        throw InputError("Online: " + name + " holds " + std::to_string(gamma.size()) + " numbers, expected " +
                         std::to_string(expected) + " finite ones");
}

Answer Online::query(const Parameter& gamma) {
    check(gamma, "gamma");
    return worker_->solve(gamma);
}

std::vector<Answer> Online::solve_many(std::span<const Parameter> gammas, int threads) const {
    if (threads < 1) throw InputError("Online: threads is " + std::to_string(threads) + ", expected at least 1");
    for (std::size_t k = 0; k < gammas.size(); ++k) check(gammas[k], "gammas[" + std::to_string(k) + "]");
    std::vector<Answer> answers(gammas.size());
    std::vector<std::exception_ptr> errors(static_cast<std::size_t>(threads));
    constexpr std::size_t block = 16;  // queries of a microsecond are too short to be handed out one by one
    std::atomic<std::size_t> next = 0;
    const auto work = [&](std::size_t thread) {
        try {
            Worker worker(model_->unshared(), method_, options_);
            for (std::size_t k = next.fetch_add(block); k < gammas.size(); k = next.fetch_add(block))
                for (std::size_t j = k; j < std::min(k + block, gammas.size()); ++j)
                    answers[j] = worker.solve(gammas[j]);
        } catch (...) {
            errors[thread] = std::current_exception();
        }
    };
    {
        std::vector<std::jthread> others;
        for (std::size_t thread = 1; thread < errors.size(); ++thread) others.emplace_back(work, thread);
        work(0);
    }
    for (const std::exception_ptr& error : errors)
        if (error) std::rethrow_exception(error);
    return answers;
}

}  // namespace tact
