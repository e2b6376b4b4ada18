// Greedy training of a reduced basis over a box of parameters.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string_view>

#include "../bases/compressed_basis.hpp"
#include "../bases/snapshots.hpp"
#include "../error/indicator.hpp"
#include "../model/reduce.hpp"
#include "training_run.hpp"

namespace tact {

/// The contact solvers of full and of reduced problems.
struct TrainingContact {
    std::shared_ptr<const ContactSolver> full;
    std::shared_ptr<const ContactSolver> reduced;
};

/// The paper's growth for marches: p = p_lambda = 2 + 98 (N - 1) / 9 in integers; 100 after ten samples.
BasisSizes paper_sizes(int samples);

/// What becomes of the snapshots. `none`: U is their orthonormalised span and U_lambda their scaled multipliers, one
/// column each (a snapshot without contact adds no dual one).
enum class Compression { none, pod_and_dual_basis };

/// Where training is: `iteration` of at most `iterations`, and how far its stage has come, 0 to 1.
struct TrainingProgress {
    int iteration;
    int iterations;
    std::string_view stage;  ///< "full run", "POD", "dual basis", "candidates"
    double fraction;
};

struct TrainingResult;

/// Which candidate is sampled next: the one with the largest indicator, or the first not yet sampled. In order there are no
/// reduced runs, and the bases are built once, after the last sample.
enum class Selection { greedy, in_order };

struct TrainingOptions {
    std::vector<Parameter> candidates;  ///< not needed with `first` and one iteration, or without parameters
    std::optional<Parameter> first;     ///< absent: the candidate nearest the centre of the box
    Selection selection = Selection::greedy;
    int max_iterations = 10;
    double epsilon = 0;  ///< stop when I(gamma_next) < epsilon I(gamma_2)
    /// Absent: none in statics, else pod_and_dual_basis.
    std::optional<Compression> compression;
    /// Basis sizes for so many samples; not read without compression. p must not exceed the number of snapshots
    /// (InputError); p_lambda, which contact decides, is lowered to what the dual basis can give.
    std::function<BasisSizes(int samples)> sizes = paper_sizes;
    SnapshotSelection snapshots;
    IndicatorWeights weights;
    long indicator_stride = 10;         ///< J: its multiples from 1 to the last step
    std::vector<long> indicator_steps;  ///< J, instead, ascending
    /// Stands in for the indicator, such as a true error from stored full runs. Called from all threads at once.
    std::function<double(const Parameter&, const ReducedBasis&, const ReducedStates&)> oracle;
    PodAccumulatorOptions pod;  ///< max_vectors is raised to twice the largest p
    double pod_tolerance = 0;   ///< modes up to this fraction of the largest singular value are left out of U
    PrimalOptions primal;       ///< bodies, and modes beside those of the POD; not read without compression
    /// The last modes of U make way for supremizers; not read without compression.
    SupremizerOptions supremizers;
    DualBasis dual_basis = nnmf_basis();
    int threads = 1;  ///< candidates are run by so many; the result is the same for any number, to the last bit
    /// A file that holds the training after every iteration; where there is one already, training goes on from it, with
    /// the result it would have had. It is some n (max_vectors + p) numbers long, and two a dual entry. Empty: none.
    std::filesystem::path checkpoint;
    /// Called often enough for a progress bar; Flow::stop ends training after the step or sweep under way.
    std::function<Flow(const TrainingProgress&)> observer;
    /// Told the result so far when the bases of an iteration are there, before the candidates are searched.
    std::function<void(const TrainingResult&)> on_basis;
};

enum class StopReason {
    iterations,            ///< max_iterations samples
    tolerance,             ///< the indicator fell below epsilon times its first value, or is zero
    candidates_exhausted,  ///< all are sampled
    full_run_failed,
    reduced_run_failed,
    stopped  ///< by the observer
};
std::string_view to_string(StopReason reason);

/// What a full run came to, as in MarchReport.
struct FullRun {
    Outcome outcome = Outcome::converged;
    long accepted_steps = 0, first_contact_step = 0;
    Index most_active = 0;
    long contact_iterations = 0;
    KktResiduals worst_kkt;
};

/// One iteration of Algorithm 2.
struct TrainingIteration {
    Parameter gamma;            ///< sampled
    Index p = 0, p_lambda = 0;  ///< after modal_basis
    FullRun full;
    Index snapshots = 0, dual_snapshots = 0;  ///< of all samples so far
    std::vector<double> residuals;            ///< of the dual basis
    std::string warning;                      ///< of the dual basis, or empty
    std::vector<double> indicators;           ///< of each candidate; NaN where already sampled. Empty without a scan.
    double max_indicator = 0;                 ///< I(gamma_next)
    /// CPU time, of all threads.
    double seconds_full = 0, seconds_pod = 0, seconds_dual = 0, seconds_projection = 0, seconds_candidates = 0;

    template <class Archive> void serialize(Archive& archive) {
        archive(gamma, p, p_lambda, full.outcome, full.accepted_steps, full.first_contact_step, full.most_active,
                full.contact_iterations, full.worst_kkt, snapshots, dual_snapshots, residuals, warning, indicators,
                max_indicator, seconds_full, seconds_pod, seconds_dual, seconds_projection, seconds_candidates);
    }
};

struct [[nodiscard]] TrainingResult {
    Outcome outcome = Outcome::converged;  ///< of the run that failed, or stopped
    StopReason reason = StopReason::iterations;
    Parameter failed_gamma;                        ///< where a run failed
    long failed_step = 0;                          ///< its step; 0 in statics
    ReducedBasis basis;                            ///< modal; of the last iteration that completed one, else empty
    std::shared_ptr<const ContactFamily> reduced;  ///< the family in that basis, which holds the full one
    std::vector<TrainingIteration> history;
};

/// Algorithm 2, static or in time: sample the full problem, build U and U_lambda, run the reduced problem at all
/// candidates, sample next where the indicator is largest; no candidate is sampled twice. A run that does not converge
/// ends training with its outcome; the basis reached is kept. Seconds aside, the same input gives the same result.
/// Beside the full problem memory holds one block of snapshots (SnapshotRecorder), the POD's n x 2 max_vectors, the dual
/// snapshots' non-zero entries and a basis, whatever the steps and samples. InputError for options that do not fit the
/// family, a null family, or a checkpoint of another training. (Balajewicz, Amsallem, Farhat, section 4; the stopping rule is
/// printed reversed there.)
TrainingResult train(const Shared<ContactFamily>& family, const TrainingMethod& method,
                     const TrainingContact& contact, const TrainingOptions& options);

}  // namespace tact
