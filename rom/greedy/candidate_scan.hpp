// The search over the candidates, in parallel.
#pragma once

#include <vector>

#include "../../lib/problem/contact_family.hpp"
#include "../error/indicator.hpp"
#include "training_run.hpp"

namespace tact {

/// What every candidate is asked, and by how many threads.
struct CandidateScan {
    TrainingMethod method;
    std::shared_ptr<const ContactSolver> contact;  ///< of reduced problems
    std::vector<long> steps;                       ///< J, read in marches only
    int threads = 1;
    /// The indicator at gamma, from the states of its run. Called from all threads.
    std::function<double(const Parameter& gamma, const ContactProblem& reduced, const ReducedStates& states)> judge;
    /// How far the scan is, 0 to 1; false stops it. From the calling thread only.
    std::function<bool(double fraction)> progress;
};

struct [[nodiscard]] ScanResult {
    std::vector<double> indicators;        ///< of each candidate; NaN where it was skipped
    Outcome outcome = Outcome::converged;  ///< of the first candidate that failed; `stopped` by progress
    std::size_t failed = 0;                ///< that candidate
    long failed_step = 0;                  ///< its step; 0 in statics
};

/// The reduced run and its indicator at every candidate that is not skipped. Candidates go in blocks of fixed size, each with
/// contact solvers of its own, so that the result is the same for any number of threads. A reduced problem with internal
/// forces has work space of its own and is run by one thread.
ScanResult scan(const CandidateScan& task, const ContactFamily& reduced, const std::vector<Parameter>& candidates,
                const std::vector<bool>& skipped);

}  // namespace tact
