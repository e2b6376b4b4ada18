// Contact of unknowns that only contact couples: velocities under a lumped mass.
#pragma once

#include "../../lib/contact_solver.hpp"

namespace tact {

/// A diagonal with entries >= 0, rows of B that do not overlap: each row is on its own,
///   lambda_i = max(0, c_i - B_i A^-1 b) / (B_i A^-1 B_i'),
/// so a solve is a few passes over the data. InputError for other A or B.
/// An unknown j with A_jj = 0 (no mass) balances by itself: 0 = b_j + B_ij lambda_i. In a row it fixes the multiplier, 0
/// where b_j = 0, and moves from its guess no farther than the row asks; in no row it keeps its guess. Where no multiplier
/// >= 0 balances, the outcome is `unbounded`, with a ray.
class DiagonalContact final : public ContactSolver {
public:
    std::unique_ptr<PreparedContact> prepare(const Matrix& A, const Matrix& B) const override;
};

}  // namespace tact
