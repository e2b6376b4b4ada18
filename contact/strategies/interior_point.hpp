// A primal-dual interior point with an active-set finish: general sparse programmes with many overlapping rows.
#pragma once

#include "../../lib/contact_solver.hpp"

namespace tact {

/// For sparse symmetric A and any B whose active set is large or unlike any guess: equalities written as two rows, chains of
/// overlapping rows. Unknowns are scaled to unit stiffness, rows to unit length; two rows b'u >= c and -b'u >= -c become
/// one equation. Mehrotra's predictor and corrector on the quasi-definite system
///   [A  B'; B  -diag(s / lambda)]
/// (sparse L D L', one pattern), bounds condensed into its diagonal, then the set {lambda > s} solved as equations with
/// iterative refinement and corrected by a few primal-dual active-set rounds. Where that does not settle, `finish` starts
/// from its multipliers. 20 to 40 factorisations whatever the guess; lambda on entry is not read.
/// S. Mehrotra, SIAM J. Optim. 2 (1992); R. J. Vanderbei, SIAM J. Optim. 5 (1995).
class InteriorPoint final : public ContactSolver {
public:
    /// `finish`: may be null: Outcome::inaccurate or iteration_limit then.
    explicit InteriorPoint(std::shared_ptr<const ContactSolver> finish = nullptr);
    /// InputError if A is not symmetric or has a diagonal entry <= 0.
    std::unique_ptr<PreparedContact> prepare(const Matrix& A, const Matrix& B) const override;

private:
    std::shared_ptr<const ContactSolver> finish_;
};

}  // namespace tact
