// Iterative refinement around any contact solver, with residuals in twice the working precision.
#pragma once

#include "../../lib/contact_solver.hpp"

namespace tact {

/// Solves with `inner`, then for what is missing, on the same prepared matrices (scaled iterative refinement: Gleixner,
/// Steffy, Wolter, INFORMS J. Comput. 28, 2016; for QPs Weber, Sager, Gleixner, Math. Program. Comput. 11, 2019):
///   min 1/2 d'Ad - d'r,  Bd >= c - Bu,   r = b - Au + B'(lambda - s),   u := u + d,  lambda := lambda - s + delta,
/// with residuals in twice the working precision and s = min(lambda, tau max lambda), so that rows in contact can correct
/// their multiplier either way; tau = 1e-6, then 1e-12. An iterative inner solver ends at the rounding floor of the KKT
/// residual instead of at its tolerance; with a direct one u and lambda become as accurate as doubles hold them, where without
/// it they lose cond(A) roundings. A correction with larger residuals than what it corrects is dropped.
/// Costs two warm solves. Outcomes other than `converged` are the inner solver's and stay as they are.
class RefinedContact final : public ContactSolver {
public:
    explicit RefinedContact(std::shared_ptr<const ContactSolver> inner);
    std::unique_ptr<PreparedContact> prepare(const Matrix& A, const Matrix& B) const override;

private:
    std::shared_ptr<const ContactSolver> inner_;
};

}  // namespace tact
