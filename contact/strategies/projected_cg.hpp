// The primal-dual active set with conjugate gradients on the free unknowns: no factor at all.
#pragma once

#include "../../lib/contact_solver.hpp"

namespace tact {

/// For well-conditioned sparse symmetric A (a time step that resolves the stiff modes) and constraints that do not
/// overlap (bounds, node-to-node pairs). A is scaled to unit diagonal, rows to unit length, so that the active-set
/// rule lambda_i + (c_i - B_i u) > 0 needs no constant. The inner solves are inexact until the set settles; a set that
/// comes back at full accuracy ends as Outcome::cycling, with the point untouched.
class ProjectedCg final : public ContactSolver {
public:
    /// InputError if A is not symmetric, has a diagonal entry <= 0, or rows of B overlap.
    std::unique_ptr<PreparedContact> prepare(const Matrix& A, const Matrix& B) const override;
};

}  // namespace tact
