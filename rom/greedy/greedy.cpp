#include "greedy.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "../bases/stopwatch.hpp"
#include "candidate_scan.hpp"
#include "checkpoint.hpp"
#include "sampling.hpp"

namespace tact {
namespace {

class Training {
public:
    Training(const Shared<ContactFamily>& family, const TrainingMethod& method, const TrainingContact& contact,
             const TrainingOptions& options);
    TrainingResult run();

private:
    bool resume();
    void save();
    Parameter first_sample() const;
    bool sample(const Parameter& gamma);
    bool run_full(const Parameter& gamma);
    void take_primal(const Eigen::Ref<const DenseMatrix>& snapshots);
    bool build_basis();
    ReducedBasis raw_basis() const;
    bool compress();
    void reduce_family();
    bool complete() const;
    bool bases_due() const;
    bool go_on(Parameter& gamma);
    bool search(Parameter& gamma);
    bool scan_candidates();
    bool failed(Outcome outcome, StopReason reason, const Parameter& gamma, long step);
    bool ended(StopReason reason);
    bool tell(std::string_view stage, double fraction);
    TrainingIteration& current() { return state_.history.back(); }
    int samples() const { return static_cast<int>(state_.history.size()); }
    void mark_sampled(const Parameter& gamma);
    std::size_t next_candidate();

    Shared<ContactFamily> family_;
    const TrainingMethod& method_;
    const TrainingContact& contact_;
    const TrainingOptions& options_;
    std::vector<Parameter> candidates_;
    std::vector<bool> sampled_;
    Compression compression_;
    TrainingState state_;
    std::vector<long> indicator_steps_;
    TrainingIdentity identity_;  // where there is a checkpoint
    TrainingResult result_;      // takes history and basis from the state at the end
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
        throw InputError("TrainingOptions: pod_tolerance is " + shown(options.pod_tolerance) +
                         ", expected 0 <= pod_tolerance < 1");
    if (!(options.supremizers.share >= 0 && options.supremizers.share < 1))
        throw InputError("TrainingOptions: supremizers.share is " + shown(options.supremizers.share) +
                         ", expected 0 <= share < 1");
    PodAccumulatorOptions pod = options.pod;
    pod.max_vectors = std::max(pod.max_vectors, 2 * options.sizes(options.max_iterations).p);
    return pod;
}

Training::Training(const Shared<ContactFamily>& family, const TrainingMethod& method, const TrainingContact& contact,
                   const TrainingOptions& options)
    : family_(family),
      method_(method),
      contact_(contact),
      options_(options),
      candidates_(checked_candidates(*family, options)),
      sampled_(candidates_.size(), false),
      compression_(
          options.compression.value_or(method.integrator ? Compression::pod_and_dual_basis : Compression::none)),
      state_(family->at(first_sample()).constraints(), pod_options(options)),
      indicator_steps_(checked_indicator_steps(method, options)) {
    if (options.max_iterations < 1)
        throw InputError("TrainingOptions: max_iterations is " + std::to_string(options.max_iterations) +
                         ", expected at least 1");
    if (!(options.epsilon >= 0 && options.epsilon < 1))
        throw InputError("TrainingOptions: epsilon is " + shown(options.epsilon) + ", expected 0 <= epsilon < 1");
    if (options.threads < 1)
        throw InputError("TrainingOptions: threads is " + std::to_string(options.threads) + ", expected at least 1");
}

TrainingResult Training::run() {
    Parameter gamma = first_sample();
    for (bool resumed = resume();; resumed = false) {
        if (!resumed && !(sample(gamma) && (!bases_due() || build_basis()))) break;
        const bool more = options_.selection == Selection::greedy ? search(gamma) : go_on(gamma);
        if (result_.outcome != Outcome::converged) break;
        if (!resumed) save();
        if (!more) break;
    }
    result_.history = std::move(state_.history);
    result_.basis = std::move(state_.basis);
    return std::move(result_);
}

Parameter Training::first_sample() const {
    if (options_.first) return *options_.first;
    if (options_.selection == Selection::in_order) return candidates_.front();
    return candidates_[static_cast<std::size_t>(nearest_to_centre(candidates_, family_->lower(), family_->upper()))];
}

/// Takes up the state of the checkpoint, if there is one.
bool Training::resume() {
    if (options_.checkpoint.empty()) return false;
    identity_ = training_identity(*family_, method_, options_, pod_options(options_));
    if (!read_checkpoint(options_.checkpoint, identity_, state_)) return false;
    if (samples() > options_.max_iterations)
        throw InputError("train: checkpoint " + options_.checkpoint.string() + " holds " + std::to_string(samples()) +
                         " iterations, expected at most max_iterations, " + std::to_string(options_.max_iterations));
    for (const TrainingIteration& iteration : state_.history) mark_sampled(iteration.gamma);
    if (state_.basis.primal_size() > 0) reduce_family();
    return true;
}

void Training::save() {
    if (!options_.checkpoint.empty()) write_checkpoint(options_.checkpoint, identity_, state_);
}

void Training::mark_sampled(const Parameter& gamma) {
    for (std::size_t j = 0; j < candidates_.size(); ++j)
        if (candidates_[j] == gamma) sampled_[j] = true;
}

bool Training::complete() const {
    return samples() == options_.max_iterations || std::ranges::find(sampled_, false) == sampled_.end();
}

bool Training::bases_due() const { return options_.selection == Selection::greedy || complete(); }

/// The next candidate in order, or why training ends here.
bool Training::go_on(Parameter& gamma) {
    if (samples() == options_.max_iterations) return ended(StopReason::iterations);
    if (complete()) return ended(StopReason::candidates_exhausted);
    gamma = candidates_[static_cast<std::size_t>(std::ranges::find(sampled_, false) - sampled_.begin())];
    return true;
}

/// Steps 6 to 18: where to sample next, or why training ends here.
bool Training::search(Parameter& gamma) {
    if (samples() == options_.max_iterations) return ended(StopReason::iterations);
    if (complete()) return ended(StopReason::candidates_exhausted);
    if (current().indicators.empty() && !scan_candidates()) return false;
    const std::size_t next = next_candidate();
    current().max_indicator = current().indicators[next];
    if (current().max_indicator < options_.epsilon * state_.history.front().max_indicator ||
        current().max_indicator == 0)
        return ended(StopReason::tolerance);
    gamma = candidates_[next];
    return true;
}

bool Training::ended(StopReason reason) {
    result_.reason = reason;
    return false;
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
    state_.history.emplace_back();
    current().gamma = gamma;
    mark_sampled(gamma);
    if (!tell("full run", 0) || !run_full(gamma) || !tell("POD", 0)) return false;
    current().snapshots = compression_ == Compression::none ? state_.raw.cols() : state_.pod.snapshots();
    current().dual_snapshots = state_.dual.size();
    return true;
}

bool Training::run_full(const Parameter& gamma) {
    MarchReport march;
    {
        const Stopwatch watch(current().seconds_full);
        const ContactProblem problem = family_->at(gamma);
        SnapshotRecorder recorder(problem.size(), method_.integrator ? method_.grid.steps : 0, options_.snapshots,
                                  state_.dual, [this](const auto& snapshots) { take_primal(snapshots); });
        std::vector<Observer> observers{recorder.observer()};
        if (method_.integrator)
            observers.emplace_back([this](const State& state, const StepReport&) {
                const double done = static_cast<double>(state.step) / static_cast<double>(method_.grid.steps);
                return tell("full run", done) ? Flow::proceed : Flow::stop;
            });
        // Its own contact solvers: what others remember of earlier samples would be missing after a resumption.
        ContactWorkspace workspace(contact_.full);
        march = run_by(method_, problem, workspace, observers);
        recorder.flush();
    }
    current().seconds_full -= current().seconds_pod;  // compression goes on during the run
    current().full = {march.outcome,     march.accepted_steps,     march.first_contact_step,
                      march.most_active, march.contact_iterations, march.worst_kkt};
    return !failed(march.outcome, StopReason::full_run_failed, gamma, march.last.step);
}

void Training::take_primal(const Eigen::Ref<const DenseMatrix>& snapshots) {
    const Stopwatch watch(current().seconds_pod);
    if (compression_ == Compression::pod_and_dual_basis) {
        state_.pod.add(snapshots);
        return;
    }
    const Index held = state_.raw.cols();
    state_.raw.conservativeResize(snapshots.rows(), held + snapshots.cols());
    state_.raw.rightCols(snapshots.cols()) = snapshots;
}

ReducedBasis Training::raw_basis() const {
    ReducedBasis basis{state_.raw, DenseMatrix(state_.dual.matrix())};
    basis.U_lambda.colwise().normalize();
    return basis;
}

bool Training::compress() {
    if (!tell("dual basis", 0)) return false;
    CompressedBasis built = compressed_basis(family_->at(current().gamma), state_.pod, state_.dual,
                                             {options_.sizes(samples()), options_.pod_tolerance, options_.primal,
                                              options_.dual_basis, options_.supremizers},
                                             [this](double fraction) { return tell("dual basis", fraction); });
    current().seconds_pod += built.seconds_pod;
    current().seconds_dual += built.seconds_dual;
    current().seconds_projection += built.seconds_projection;
    current().residuals = std::move(built.residuals);
    current().warning = std::move(built.warning);
    if (result_.outcome == Outcome::stopped) return false;
    state_.basis = std::move(built.basis);
    return true;
}

/// Steps 4 and 5: both bases, and the reduced family in modal coordinates.
bool Training::build_basis() {
    if (compression_ == Compression::none) {
        const Stopwatch watch(current().seconds_projection);
        if (state_.raw.cols() > 0) state_.basis = modal_basis(family_->at(current().gamma), raw_basis());
    } else if (!compress()) {
        return false;
    }
    if (state_.basis.U.cols() == 0)
        throw InputError("train: all snapshots of the full run are zero, expected a solution that moves");
    reduce_family();
    current().p = state_.basis.primal_size();
    current().p_lambda = state_.basis.dual_size();
    if (options_.on_basis) {
        result_.history = state_.history;
        result_.basis = state_.basis;
        options_.on_basis(result_);
    }
    return true;
}

void Training::reduce_family() {
    const Stopwatch watch(current().seconds_projection);
    result_.reduced = reduce(family_, state_.basis);
}

/// Steps 10 to 13: the reduced run and its indicator at every candidate not yet sampled.
bool Training::scan_candidates() {
    if (!tell("candidates", 0)) return false;
    std::optional<Indicator> indicator;
    if (!options_.oracle) {
        const Stopwatch watch(current().seconds_projection);
        indicator.emplace(family_, state_.basis, options_.weights);
    }
    const Stopwatch watch(current().seconds_candidates);
    const CandidateScan task{
        .method = method_,
        .contact = contact_.reduced,
        .steps = indicator_steps_,
        .threads = options_.threads,
        .judge =
            [&](const Parameter& gamma, const ContactProblem& reduced, const ReducedStates& states) {
                return indicator ? (*indicator)(gamma, reduced, states)
                                 : options_.oracle(gamma, state_.basis, states);
            },
        .progress = [this](double fraction) { return tell("candidates", fraction); }};
    ScanResult found = scan(task, *result_.reduced, candidates_, sampled_);
    if (found.failed < candidates_.size())
        return !failed(found.outcome, StopReason::reduced_run_failed, candidates_[found.failed], found.failed_step);
    current().indicators = std::move(found.indicators);
    return found.outcome == Outcome::converged;
}

bool Training::failed(Outcome outcome, StopReason reason, const Parameter& gamma, long step) {
    if (outcome == Outcome::converged) return false;
    result_.outcome = outcome;
    result_.reason = outcome == Outcome::stopped ? StopReason::stopped : reason;
    result_.failed_gamma = gamma;
    result_.failed_step = step;
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

TrainingResult train(const Shared<ContactFamily>& family, const TrainingMethod& method,
                     const TrainingContact& contact, const TrainingOptions& options) {
    if (!family) throw InputError("train: the family is null");
    return Training(family, method, contact, options).run();
}

}  // namespace tact
