// How far a reduced run is from its full one.
#pragma once

#include "../../lib/time/trajectory.hpp"
#include "../model/reduced_basis.hpp"

namespace tact {

/// Errors of U q against u over the columns compared.
struct RelativeError {
    double squared_percent = 0;  ///< 100 sum |U q - u|^2 / sum |u|^2: eqs. 16 and 17 as printed
    double norm_percent = 0;     ///< 100 sqrt(sum |U q - u|^2 / sum |u|^2)
    /// Largest entry of [B U q - c]_-, in units of the gap scale max |c| (finite rows, all times; max |B U q| if c = 0).
    double penetration = 0;
};

/// u: n x N full states, q: p x N reduced ones, at `times` (N). U q is formed a few rows at a time. Where u is zero the
/// errors are 0 if U q is too, else infinite. InputError if shapes differ.
RelativeError relative_error(const ContactProblem& full, const Eigen::Ref<const DenseMatrix>& u,
                             const ReducedBasis& basis, const Eigen::Ref<const DenseMatrix>& q,
                             const std::vector<double>& times);

/// Eq. 17 over the recorded states of two marches; InputError unless they were recorded at the same times (1e-9 of the
/// last).
RelativeError relative_error(const ContactProblem& full, const Trajectory& u, const ReducedBasis& basis,
                             const Trajectory& q);

/// Eq. 16.
RelativeError relative_error(const ContactProblem& full, const StaticSolution& u, const ReducedBasis& basis,
                             const StaticSolution& q);

}  // namespace tact
