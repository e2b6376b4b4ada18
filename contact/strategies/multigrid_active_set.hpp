// The primal-dual active set with multigrid inside: for large ill-conditioned bound problems that change too often to
// pay for a factor.
#pragma once

#include "../../lib/contact_solver.hpp"

namespace tact {

/// For large sparse symmetric A near an M-matrix (diffusion, membranes; any numbering, no grid is asked for) and rows
/// of B with a single entry each (bounds; several rows may bound one unknown, from both sides too).
///
///   start: the obstacle problem of the correction on the coarse levels of a smoothed-aggregation hierarchy, coarsest
///          first; the bound of an aggregate is that of its root
///   round: x to its bounds where beyond them, rows with negative multiplier released, on the residual in double; then
///          a few steps of conjugate gradients on the free unknowns, preconditioned by a multigrid cycle with the others masked
///   end:   set unchanged and residual at the floor, about 1e-13 in the scale of the certificate
///
/// All corrections are in single precision, all decisions on the double residual. A set that comes back at full accuracy
/// ends as Outcome::cycling, bounds that exclude each other as infeasible; the point is untouched then.
/// (Hintermueller, Ito, Kunisch, SIAM J. Optim. 13, 2003; Vanek, Mandel, Brezina, Computing 56, 1996.)
class MultigridActiveSet final : public ContactSolver {
public:
    /// InputError if A is not symmetric, has a diagonal entry <= 0, or B a row that does not have exactly one entry;
    /// NumericalError if A turns out not to be positive definite.
    std::unique_ptr<PreparedContact> prepare(const Matrix& A, const Matrix& B) const override;
};

}  // namespace tact
