// The primal basis: POD of the snapshots, whole or body by body, and modes that are given.
#pragma once

#include "../../lib/algebra/linear_solver.hpp"
#include "../../lib/problem/contact_problem.hpp"
#include "pod_accumulator.hpp"

namespace tact {

struct PrimalOptions {
    /// The body of each unknown, numbered from 0: every mode moves one body only, and the p modes go to the bodies by their
    /// singular values, so that one without motion gets none. Empty: modes move all at once.
    std::vector<Index> body_of;
    /// n x k: modes that U holds beside the p of the POD, which is then that of what they leave of the snapshots. With bodies,
    /// the parts of each column in each body are modes of their own.
    DenseMatrix held;
};

/// n x r: an orthonormal basis of `held`, then at most p modes by descending singular value, orthonormal in the
/// snapshots' inner product (of different bodies, where it does not couple them). Modes up to `tolerance` or 1e-7 of the
/// snapshots' largest singular value are left out. InputError if p exceeds the number of snapshots or the options do not fit.
DenseMatrix primal_basis(const PodAccumulator& snapshots, Index p, double tolerance,
                         const PrimalOptions& options = {});

/// body_of: the connected parts of K's graph, in the order of their first unknowns.
std::vector<Index> connected_bodies(const Matrix& K);

/// n x (loads + rows): K^-1 f for each of the load's modes that is not zero, and K^-1 B'e_i, the displacement under a unit force in
/// each of these rows, in their order: with them in U static answers to such loads are exact (the attachment modes of component
/// mode synthesis; Craig, Int. J. Anal. Exp. Modal Anal. 2, 1987). At unit length. InputError for a row that does not
/// exist; NumericalError if K is singular.
DenseMatrix static_modes(const ContactProblem& problem, const std::vector<Index>& rows, const LinearSolver& linear);

}  // namespace tact
