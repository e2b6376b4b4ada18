#include "tact/rom/training/greedy.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "tact/rom/training/sampling.hpp"
#include "tact/rom/training/stopwatch.hpp"

namespace tact {
namespace {

class Training {
public:
    Training(const ContactFamily& family, const TrainingMethod& method, const TrainingContact& contact,
             const TrainingOptions& options);
    TrainingResult run();

private:
    bool sample(const Parameter& gamma);
    bool build_basis();
    ReducedBasis raw_basis() const;
    bool compress();
    bool scan();
    MarchReport march(const ContactProblem& problem, ContactWorkspace& workspace, const Observer& record,
                      bool report_steps);
    bool failed(const MarchReport& march, StopReason reason, const Parameter& gamma);
    bool tell(std::string_view stage, double fraction);
    TrainingIteration& current() { return result_.history.back(); }
    int samples() const { return static_cast<int>(result_.history.size()); }
    std::size_t next_candidate();

    const ContactFamily& family_;
    const TrainingMethod& method_;
    const TrainingContact& contact_;
    const TrainingOptions& options_;
    std::vector<Parameter> candidates_;
    std::vector<bool> sampled_;
    Compression compression_;
    ContactWorkspace full_workspace_;
    DualSnapshots dual_;
    SnapshotRecorder recorder_;
    PodAccumulator pod_;
    DenseMatrix raw_;
    std::vector<long> indicator_steps_;
    TrainingResult result_;
};

std::vector<Parameter> checked_candidates(const ContactFamily& family, const TrainingOptions& options) {
    const Index size = static_cast<Index>(family.names().size());
    std::vector<Parameter> candidates = options.candidates;
    if (size == 0 && candidates.empty()) candidates.emplace_back();
    if (candidates.empty() && !options.first)
        throw InputError("TrainingOptions: there are no candidates and no first sample, expected at least one");
    const auto check = [&](const Parameter& gamma, const std::string& name) {
        if (gamma.size() != size || !gamma.allFinite())
            throw InputError("TrainingOptions: " + name + " holds " + std::to_string(gamma.size()) +
                             " numbers, expected " + std::to_string(size) + " finite ones");
    };
    for (std::size_t j = 0; j < candidates.size(); ++j) check(candidates[j], "candidates[" + std::to_string(j) + "]");
    if (options.first) check(*options.first, "first");
    return candidates;
}

std::vector<long> checked_indicator_steps(const TrainingMethod& method, const TrainingOptions& options) {
    if (!options.indicator_steps.empty()) return options.indicator_steps;
    if (options.indicator_stride < 1)
        throw InputError("TrainingOptions: indicator_stride is " + std::to_string(options.indicator_stride) +
                         ", expected at least 1");
    std::vector<long> steps;
    for (long n = options.indicator_stride; n <= method.grid.steps; n += options.indicator_stride) steps.push_back(n);
    return steps;
}

PodAccumulatorOptions pod_options(const TrainingOptions& options) {
    if (!options.dual_basis) throw InputError("TrainingOptions: dual_basis is empty, expected a recipe");
    if (!options.sizes)
        throw InputError("TrainingOptions: sizes is empty, expected a function of the number of samples");
    if (!(options.pod_tolerance >= 0 && options.pod_tolerance < 1))
        throw InputError("TrainingOptions: pod_tolerance is " + std::to_string(options.pod_tolerance) +
                         ", expected 0 <= pod_tolerance < 1");
    if (!(options.supremizers.share >= 0 && options.supremizers.share < 1))
        throw InputError("TrainingOptions: supremizers.share is " + std::to_string(options.supremizers.share) +
                         ", expected 0 <= share < 1");
    PodAccumulatorOptions pod = options.pod;
    pod.max_vectors = std::max(pod.max_vectors, 2 * options.sizes(options.max_iterations).p);
    return pod;
}

Training::Training(const ContactFamily& family, const TrainingMethod& method, const TrainingContact& contact,
                   const TrainingOptions& options)
    : family_(family),
      method_(method),
      contact_(contact),
      options_(options),
      candidates_(checked_candidates(family, options)),
      sampled_(candidates_.size(), false),
      compression_(
          options.compression.value_or(method.integrator ? Compression::pod_and_dual_basis : Compression::none)),
      full_workspace_(contact.full),
      dual_(family.at(candidates_.empty() ? *options.first : candidates_.front()).constraints()),
      recorder_(family.at(candidates_.empty() ? *options.first : candidates_.front()).size(),
                method.integrator ? method.grid.steps : 0, options.strides, dual_),
      pod_(pod_options(options)),
      indicator_steps_(checked_indicator_steps(method, options)) {
    if (options.max_iterations < 1)
        throw InputError("TrainingOptions: max_iterations is " + std::to_string(options.max_iterations) +
                         ", expected at least 1");
    if (!(options.epsilon >= 0 && options.epsilon < 1))
        throw InputError("TrainingOptions: epsilon is " + std::to_string(options.epsilon) +
                         ", expected 0 <= epsilon < 1");
}

TrainingResult Training::run() {
    Parameter gamma =
        options_.first
            ? *options_.first
            : candidates_[static_cast<std::size_t>(nearest_to_centre(candidates_, family_.lower(), family_.upper()))];
    for (;;) {
        if (!sample(gamma) || !build_basis()) return std::move(result_);
        if (samples() == options_.max_iterations) {
            result_.reason = StopReason::iterations;
            return std::move(result_);
        }
        if (std::find(sampled_.begin(), sampled_.end(), false) == sampled_.end()) {
            result_.reason = StopReason::candidates_exhausted;
            return std::move(result_);
        }
        if (!scan()) return std::move(result_);
        const std::size_t next = next_candidate();
        current().max_indicator = current().indicators[next];
        if (current().max_indicator < options_.epsilon * result_.history.front().max_indicator ||
            current().max_indicator == 0) {
            result_.reason = StopReason::tolerance;
            return std::move(result_);
        }
        gamma = candidates_[next];
    }
}

/// The unsampled candidate with the largest indicator, the first of equals.
std::size_t Training::next_candidate() {
    const std::vector<double>& indicators = current().indicators;
    std::size_t best = candidates_.size();
    for (std::size_t j = 0; j < candidates_.size(); ++j)
        if (!sampled_[j] && (best == candidates_.size() || indicators[j] > indicators[best])) best = j;
    return best;
}

/// Steps 2 and 3: the full run at gamma and its snapshots.
bool Training::sample(const Parameter& gamma) {
    result_.history.emplace_back();
    current().gamma = gamma;
    for (std::size_t j = 0; j < candidates_.size(); ++j)
        if (candidates_[j] == gamma) sampled_[j] = true;
    if (!tell("full run", 0)) return false;
    {
        const Stopwatch watch(current().seconds_full);
        const ContactProblem problem = family_.at(gamma);
        current().march = march(problem, full_workspace_, recorder_.observer(), true);
    }
    if (failed(current().march, StopReason::full_run_failed, gamma)) return false;
    if (!tell("POD", 0)) return false;
    const Stopwatch watch(current().seconds_pod);
    if (compression_ == Compression::none) {
        const Index held = raw_.cols();
        raw_.conservativeResize(recorder_.primal().rows(), held + recorder_.primal().cols());
        raw_.rightCols(recorder_.primal().cols()) = recorder_.primal();
    } else {
        pod_.add(recorder_.primal());
    }
    return true;
}

ReducedBasis Training::raw_basis() const {
    ReducedBasis basis{raw_, DenseMatrix(dual_.matrix())};
    basis.U_lambda.colwise().normalize();
    return basis;
}

bool Training::compress() {
    if (!tell("dual basis", 0)) return false;
    CompressedBasis built = compressed_basis(
        family_.at(current().gamma), pod_, dual_,
        {options_.sizes(samples()), options_.pod_tolerance, options_.dual_basis, options_.supremizers},
        [this](double fraction) { return tell("dual basis", fraction); });
    current().seconds_pod += built.seconds_pod;
    current().seconds_dual += built.seconds_dual;
    current().seconds_projection += built.seconds_projection;
    current().residuals = std::move(built.residuals);
    current().warning = std::move(built.warning);
    if (result_.outcome == Outcome::stopped) return false;
    result_.basis = std::move(built.basis);
    return true;
}

/// Steps 4 and 5: both bases, and the reduced family in modal coordinates.
bool Training::build_basis() {
    if (compression_ == Compression::none) {
        const Stopwatch watch(current().seconds_projection);
        if (raw_.cols() > 0) result_.basis = modal_basis(family_.at(current().gamma), raw_basis());
    } else if (!compress()) {
        return false;
    }
    if (result_.basis.U.cols() == 0)
        throw InputError("train: all snapshots of the full run are zero, expected a solution that moves");
    const Stopwatch watch(current().seconds_projection);
    result_.reduced = reduce(family_, result_.basis);
    current().p = result_.basis.primal_size();
    current().p_lambda = result_.basis.dual_size();
    return true;
}

/// Steps 10 to 13: the reduced run and its indicator at every candidate not yet sampled.
bool Training::scan() {
    if (!tell("candidates", 0)) return false;
    std::optional<Indicator> indicator;
    if (!options_.oracle) {
        const Stopwatch watch(current().seconds_projection);
        indicator.emplace(family_, result_.basis, options_.weights);
    }
    const Stopwatch watch(current().seconds_candidates);
    ContactWorkspace workspace(contact_.reduced);
    ReducedStateRecorder recorder(method_.integrator ? indicator_steps_ : std::vector<long>{0});
    current().indicators.assign(candidates_.size(), std::numeric_limits<double>::quiet_NaN());
    for (std::size_t j = 0; j < candidates_.size(); ++j) {
        if (sampled_[j]) continue;
        const Parameter& gamma = candidates_[j];
        const ContactProblem problem = result_.reduced->at(gamma);
        const MarchReport report = march(problem, workspace, recorder.observer(problem), false);
        if (failed(report, StopReason::reduced_run_failed, gamma)) return false;
        current().indicators[j] = indicator ? (*indicator)(gamma, problem, recorder.states())
                                            : options_.oracle(gamma, result_.basis, recorder.states());
        if (!tell("candidates", static_cast<double>(j + 1) / static_cast<double>(candidates_.size()))) return false;
    }
    return true;
}

/// A march, or a static solution told to `record` as a state at step 0.
MarchReport Training::march(const ContactProblem& problem, ContactWorkspace& workspace, const Observer& record,
                            bool report_steps) {
    if (method_.integrator) {
        std::vector<Observer> observers{record};
        if (report_steps)
            observers.emplace_back([this](const State& state, const StepReport&) {
                const double done = static_cast<double>(state.step) / static_cast<double>(method_.grid.steps);
                return tell("full run", done) ? Flow::proceed : Flow::stop;
            });
        return integrate(*method_.integrator, problem, method_.grid, workspace, observers);
    }
    validate(problem);
    StaticSolution solution = solve_static(problem, workspace);
    MarchReport report;
    report.outcome = report.last.outcome = solution.report.outcome;
    report.last.contact = solution.report;
    report.worst_kkt = solution.report.kkt;
    report.most_active = solution.report.active;
    report.contact_iterations = solution.report.iterations;
    if (report.outcome != Outcome::converged) return report;
    report.final_state = State(problem);
    report.final_state.y = std::move(solution.u);
    report.final_state.lambda = std::move(solution.lambda);
    record(report.final_state, report.last);
    return report;
}

bool Training::failed(const MarchReport& report, StopReason reason, const Parameter& gamma) {
    if (report.outcome == Outcome::converged) return false;
    result_.outcome = report.outcome;
    result_.reason = report.outcome == Outcome::stopped ? StopReason::stopped : reason;
    result_.failed_gamma = gamma;
    result_.failed_step = report.last.step;
    return true;
}

/// Reports progress; false if the user wants to stop.
bool Training::tell(std::string_view stage, double fraction) {
    if (!options_.observer) return true;
    if (options_.observer({samples(), options_.max_iterations, stage, fraction}) == Flow::proceed) return true;
    result_.outcome = Outcome::stopped;
    result_.reason = StopReason::stopped;
    return false;
}

}  // namespace

BasisSizes paper_sizes(int samples) {
    const Index p = 2 + 98 * (samples - 1) / 9;
    return {p, p};
}

std::string_view to_string(StopReason reason) {
    switch (reason) {
        case StopReason::iterations: return "iterations";
        case StopReason::tolerance: return "tolerance";
        case StopReason::candidates_exhausted: return "candidates exhausted";
        case StopReason::full_run_failed: return "full run failed";
        case StopReason::reduced_run_failed: return "reduced run failed";
        case StopReason::stopped: return "stopped";
    }
    return "unknown";
}

TrainingResult train(const ContactFamily& family, const TrainingMethod& method, const TrainingContact& contact,
                     const TrainingOptions& options) {
    return Training(family, method, contact, options).run();
}

}  // namespace tact
