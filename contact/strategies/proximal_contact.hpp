// Semidefinite A: a floating body that contact holds, a problem with directions that cost nothing.
#pragma once

#include "../../lib/contact_solver.hpp"

namespace tact {

/// Proximal-point iteration around another solver:  u_k+1 = argmin 1/2 u'Au - u'b + delta/2 |u - u_k|^2,  Bu >= c,  with a
/// diagonal delta far below A's own. Converges to a solution wherever one exists (R. T. Rockafellar, SIAM J. Control Optim.
/// 14, 1976), in a few iterations since only the directions without stiffness are left to it. Where none does, the
/// iterates run off along a ray: Outcome::unbounded, with the ray d (A d = 0, B d >= 0, b'd > 0) in the report.
/// InputError if A is not symmetric or not positive semidefinite to rounding (a negative eigenvalue).
class ProximalContact final : public ContactSolver {
public:
    /// `inner` solves the definite problems.
    explicit ProximalContact(std::shared_ptr<const ContactSolver> inner);
    std::unique_ptr<PreparedContact> prepare(const Matrix& A, const Matrix& B) const override;

private:
    std::shared_ptr<const ContactSolver> inner_;
};

}  // namespace tact
