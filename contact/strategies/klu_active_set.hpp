// The primal-dual active set condensed into one sparse matrix of fixed pattern, refactored by KLU.
#pragma once

#include "../../lib/contact_solver.hpp"

namespace tact {

/// The general strategy: any sparse A, symmetric or not, with positive definite symmetric part; any B. Where few rows are
/// touched: one factor of A and a pool of them (touched_rows.hpp). Where many are, or many at once: active row i
/// replaces the equilibrium of one unknown of its own and its multiplier is eliminated, so the system stays n x n; rows
/// without an unknown of their own keep their multiplier as an extra unknown. One pattern, one symbolic analysis
/// ever, klu_l_refactor after. Bounds that are far from the guess get a nested start (prepare/nested_start.hpp). The primal-dual active set of Hintermueller, Ito, Kunisch (SIAM J. Optim. 13, 2002).
/// A set that comes back is followed by careful exchanges (dense/exchanges.hpp). Ends `inaccurate` where rows in contact are
/// dependent, `iteration_limit` or `cycling` where rounding keeps the sets from an end.
class KluActiveSet final : public ContactSolver {
public:
    std::unique_ptr<PreparedContact> prepare(const Matrix& A, const Matrix& B) const override;
};

}  // namespace tact
