// Projected over-relaxation by colours: the fastest strategy where A is well conditioned and contact is by bounds.
#pragma once

#include "../../lib/contact_solver.hpp"

namespace tact {

/// For sparse symmetric A with a small condition number and rows of B with a single entry each (bounds; two rows may
/// bound one unknown from both sides). Unknowns are ordered by colour, so that a sweep
///   d_i := min(max(d_i + omega (r - A d)_i / a_ii, lower_i), upper_i)
/// runs at vector speed; omega from the spectrum's Lanczos estimate. Sweeps are in single precision on the defect r = b - A u,
/// which is taken in double precision, some five digits at a time. No active set is guessed: an unknown is in contact if
/// a correction leaves it on its bound, which is then met exactly, and b - A u in double precision holds it there; until
/// that is so everywhere another correction follows. Over-relaxation converges for every symmetric positive definite A and
/// 0 < omega < 2 (Cryer, SIAM J. Control 9, 1971); a budget of sweeps ends as Outcome::iteration_limit.
class ColourSor final : public ContactSolver {
public:
    /// InputError if A is not symmetric, has a diagonal entry <= 0, or B a row that does not have exactly one entry.
    std::unique_ptr<PreparedContact> prepare(const Matrix& A, const Matrix& B) const override;
};

}  // namespace tact
