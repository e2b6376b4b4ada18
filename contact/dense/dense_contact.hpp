// Contact for reduced and other small problems: dense or diagonal A, one Schur complement, Goldfarb-Idnani.
#pragma once

#include "tact/lib/contact_solver.hpp"

namespace tact {

/// Prepares W = A^-1 B' and S = B W once; a solve is u = A^-1 b, a gap check, and, where rows are violated, the
/// dual active set from the multipliers it is given. A: symmetric positive definite, dense or diagonal; B: any kind.
/// InputError for a sparse A with more than 2000 unknowns; NumericalError if A is not.
class DenseContact final : public ContactSolver {
public:
    std::unique_ptr<PreparedContact> prepare(const Matrix& A, const Matrix& B) const override;
};

}  // namespace tact
