// Semidefinite A: bodies that nothing but contact holds, or that soft springs hold.
#pragma once

#include "../../lib/contact_solver.hpp"

namespace tact {

/// For constant symmetric positive semidefinite A and any B: floating bodies, mechanisms, unknowns without stiffness, and
/// nearly singular A, whose soft motions are solved for apart so that nothing cancels (contact/prepare/soft_modes.hpp). The
/// rest of A is factored once; contact is a dense saddle of the rows' compliance and the few modes
/// (contact/dense/saddle_active_set.hpp). Up to 1,500 rows are all in it from the start, more enter when they are violated.
///
/// A load on motions that no row takes part in must balance to 1e-11 of its terms; what is left of it then is spread over
/// the body. Where it does not, or rows only push the other way: Outcome::unbounded with the ray. Where motions cost
/// nothing and nothing determines them, they are those of the point nearest to none: any is a minimiser.
/// An answer whose forces do not balance along each mode within 1e-12 of their sizes is `inaccurate`, however small the
/// residual of each entry.
/// prepare: InputError if A is not symmetric, NumericalError if it is indefinite or has more than 2,000 modes.
class FloatingContact final : public ContactSolver {
public:
    std::unique_ptr<PreparedContact> prepare(const Matrix& A, const Matrix& B) const override;
};

}  // namespace tact
