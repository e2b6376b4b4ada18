// Contact of unknowns that only contact couples: velocities under a lumped mass.
#pragma once

#include "../../lib/contact_solver.hpp"

namespace tact {

/// A diagonal with positive entries, rows of B that do not overlap: each row is on its own,
///   lambda_i = max(0, c_i - B_i A^-1 b) / (B_i A^-1 B_i'),
/// so a solve is a few passes over the data. InputError for other A or B.
class DiagonalContact final : public ContactSolver {
public:
    std::unique_ptr<PreparedContact> prepare(const Matrix& A, const Matrix& B) const override;
};

}  // namespace tact
