// The last resort for small and medium problems: Goldfarb and Idnani's method on an orthogonal factor.
#pragma once

#include "../../lib/contact_solver.hpp"

namespace tact {

/// The dual active set of Goldfarb and Idnani (Math. Prog. 27, 1983) in the variables y = L' u of A = L L', keeping
/// L^-1 B_C' = Q R with Q re-orthogonalised: where the condensed form sees the square of a condition number, this sees
/// the number. Rows are judged each by its own size, so that pseudo-infinite bounds (1e20) do not blind it to others.
/// Rows that depend on the active ones are noticed at 1e-9; infeasibility is only claimed with a certificate
/// y >= 0, B'y = 0, c'y > 0 (in the report). O(n k) a step with k rows active, n k + k^2 numbers of memory: for problems up to
/// some thousand unknowns, sparse or dense. A: symmetric positive definite (NumericalError otherwise); any B.
class OrthogonalContact final : public ContactSolver {
public:
    std::unique_ptr<PreparedContact> prepare(const Matrix& A, const Matrix& B) const override;
};

}  // namespace tact
