// Errors of many bases at many parameters, from full states that are computed once.
#pragma once

#include <vector>

#include "../../rom/greedy/greedy.hpp"
#include "measure.hpp"

namespace tact::bench {

/// The contact solvers of these studies: the chooser in full, the dense one reduced.
TrainingContact study_contact();

/// A basis without what a reduced run no longer needs.
struct TestedBasis {
    DenseMatrix U;
    std::shared_ptr<const ContactFamily> reduced;  ///< in that basis
};

/// |U q_j - u_j|^2 of every column j; a few rows at a time.
Vector squared_distances(const DenseMatrix& U, const DenseMatrix& q, const Eigen::Ref<const DenseMatrix>& u);

/// Full runs at some parameters: their states side by side, equally many of each.
struct FullStates {
    std::vector<Parameter> gammas;
    DenseMatrix u;  ///< n x (gammas x states of one)
    Index width() const { return u.cols() / static_cast<Index>(gammas.size()); }
};
/// All steps of a march with its initial state, or the static solution.
FullStates full_states(const StudyScene& scene, const Scheme& scheme, const std::vector<Parameter>& gammas,
                       ContactWorkspace& workspace);

/// 100 sum |U q - u|^2 / sum |u|^2 (eqs. 16 and 17) at each parameter.
std::vector<double> squared_percents(const TestedBasis& basis, const Scheme& scheme, const FullStates& full);

}  // namespace tact::bench
