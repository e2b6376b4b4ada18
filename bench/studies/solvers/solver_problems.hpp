// The problems of the solvers study: solves recorded from the paper's scenes, with reference solutions.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "../../harness/measure.hpp"

namespace tact::bench {

/// Solves of one (A, B) in the order they are asked, and how their times become the problem's time.
struct SolverProblem {
    std::string name;
    std::string what;                        ///< in words
    std::vector<SampledSolve> samples = {};  ///< `solution` is the reference
    std::vector<double> weights = {};        ///< the problem's time is the weighted sum of the samples'
    bool cold = false;                       ///< prepare counts
    double reference_agreement = 0;          ///< two strategies' largest difference, over the largest entry
    double reference_kkt = 0;                ///< of the better one
    /// The march that the samples stand for, where a solver is fast enough to go through all of it.
    std::optional<ContactProblem> march = {};
    Scheme scheme = {};
};

/// Per scene: static-obstacle: "static, cold" and "static, next gamma"; the others "<scene>, largest contact" and
/// "<scene>, mean of the march". `n`: nodes a side, 0: the paper's; `t_end`: 0: the paper's. Every reference is the one
/// with the smaller KKT residual of the compliance's and KLU's. NumericalError if neither converges.
std::vector<SolverProblem> solver_problems(const std::string& scene, Index n = 0, double t_end = 0);

/// The same in another numbering of unknowns and of rows, drawn with a fixed seed.
SolverProblem permuted(const SolverProblem& problem);

}  // namespace tact::bench
