// What the studies measure: runs of full and reduced problems, and other solvers on a sample of a run's solves.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "../../lib/time/integrator.hpp"
#include "../../rom/model/reduced_basis.hpp"
#include "progress.hpp"
#include "sampled_contact.hpp"
#include "scenes.hpp"

namespace tact::bench {

/// A scene's scheme: none in statics.
struct Scheme {
    std::shared_ptr<const Integrator> integrator;
    TimeGrid grid;
    long steps() const { return integrator ? grid.steps : 1; }
};
/// The paper's: BDF2 at the scene's dt up to its t_end; a single solve in statics.
Scheme paper_scheme(const StudyScene& scene);

/// How a run ended and its certificate, static or in time. NumericalError that names the step if it did not converge;
/// Interrupted if it was.
struct RunSummary {
    std::string strategy;
    double worst_kkt = 0;
    Index most_active = 0;
    long first_contact_step = 0;
};
/// `who` is said where it fails. Observers see a static solution as a state at step 0.
RunSummary run(const std::string& who, const ContactProblem& problem, const Scheme& scheme,
               ContactWorkspace& workspace, std::span<const Observer> observers = {},
               const MarchOptions& options = {});

/// Steps of a march for other solvers to be timed on.
struct SampledMarch {
    std::vector<SampledSolve> samples;
    std::vector<double> stands_for;  ///< so many steps of the march each
    std::string how;                 ///< in words
};
/// Up to `in_contact` of the steps that end in contact and `free` of the others, spread evenly over either kind: what a
/// step costs differs between them by more than an order of magnitude.
SampledMarch sample_march(const std::string& who, const ContactProblem& problem, const Scheme& scheme,
                          long in_contact, long free);

/// Another solver on sampled solves of one (A, B): prepared once and warmed up on the first, neither counted.
struct Replay {
    std::vector<double> seconds;  ///< of each sample, median over the repeats
    double worst_difference = 0;  ///< |u - u_recorded| / |u_recorded|, the largest
    int not_converged = 0;
};
Replay replay(const ContactSolver& solver, const std::vector<SampledSolve>& samples, int repeats, Progress& progress);

/// The largest over parameters of eqs. 16 or 17 and of the penetration, each with all its runs certified.
struct WorstErrors {
    double squared_percent = 0, norm_percent = 0;
    double penetration = 0;        ///< in the units of u
    double penetration_share = 0;  ///< of the gap scale max |c|
    Parameter worst_gamma;         ///< of the error
    double median_squared_percent = 0;
    double worst_kkt_full = 0, worst_kkt_reduced = 0;
};
WorstErrors worst_errors(const StudyScene& scene, const Scheme& scheme, const ReducedBasis& basis,
                         const ContactFamily& reduced, const std::vector<Parameter>& gammas,
                         ContactWorkspace& full_workspace, ContactWorkspace& reduced_workspace);

}  // namespace tact::bench
