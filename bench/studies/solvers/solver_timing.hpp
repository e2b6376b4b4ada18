// Times one contact solver on the problems of the solvers study.
#pragma once

#include "../../harness/contact_solvers.hpp"
#include "../../harness/machine.hpp"
#include "solver_problems.hpp"

namespace tact::bench {

struct TimingOptions {
    int repeats = 5;
    double enough = 5;       ///< CPU s after which no repeat is begun
    double limit = 60;       ///< CPU s after which a solver is given up
    double march_at = 5;     ///< CPU s a whole march may take; slower solvers are timed on its samples
    double peer_solve = 60;  ///< CPU s after which PETSc's solve, and with it the row, is lost
};

/// {"problem", "solver", "seconds_median", "seconds_min", "iterations", "kkt_residual", "solution_error", "peer", "outcome",
/// "strategy", "how"}: seconds over the repeats of the problem's time; iterations: their mean over the solves that count,
/// kkt_residual and solution_error (max norm, relative) the worst over all. What was not measured is null and "message" says
/// why. Null altogether where the solver does not take such a problem. In a process of its own.
Json time_solver(const SolverProblem& problem, const NamedSolver& solver, const TimingOptions& options);

/// A row with everything null.
Json empty_row(const SolverProblem& problem, const std::string& solver, bool peer);

/// Fills in seconds_median and seconds_min: of the weighted sum over the samples, seconds[repeat][sample].
void put_seconds(Json& row, const SolverProblem& problem, const std::vector<std::vector<double>>& seconds);

/// |u - reference| over the largest entry of the reference.
double solution_error(const Vector& u, const SampledSolve& sample);

}  // namespace tact::bench
