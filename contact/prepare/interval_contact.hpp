// Rows with bounds on both sides, equations and bounded forces, for strategies that know contact rows only.
#pragma once

#include "../../lib/contact_solver.hpp"

namespace tact {

/// Gives `inner` rows of every kind (RowBounds): a row with an upper bound becomes B_i u >= lower_i and -B_i u >= -upper_i,
/// with lambda_i the difference of their multipliers. Which rows press with their bounded force is found by an active set of
/// its own around `inner`: they are a load then, and their bound is off. Where a set comes back, the rows that may give way
/// get an unknown s >= 0 each, B_i u + s >= lower_i, that costs force_upper_i s: one programme with a semidefinite A, which
/// `inner` must take then.
/// The certificate is that of the rows as they were given. Outcomes other than `converged` are those of `inner`.
class IntervalContact final : public ContactSolver {
public:
    explicit IntervalContact(std::shared_ptr<const ContactSolver> inner);
    std::unique_ptr<PreparedContact> prepare(const Matrix& A, const Matrix& B) const override;
    std::unique_ptr<PreparedContact> prepare_rows(const Matrix& A, const Matrix& B) const override {
        return prepare(A, B);
    }

private:
    std::shared_ptr<const ContactSolver> inner_;
};

/// InputError unless lower <= upper, no lower bound is +infinity and no upper one -infinity, force_lower <= 0 <= force_upper
/// and no entry is NaN; names the row.
void check_row_bounds(const RowBounds& rows);

}  // namespace tact
