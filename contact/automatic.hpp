// Picks a contact strategy from what A and B are, and another one when the solves show that it should.
#pragma once

#include <optional>
#include <vector>

#include "../lib/contact_solver.hpp"

namespace tact {

enum class ContactStrategy {
    diagonal,
    dense,
    klu_active_set,
    colour_sor,
    projected_cg,
    multigrid_active_set,
    interior_point,
    schur,
    orthogonal,
    principal_pivoting,
    floating
};

struct AutomaticOptions {
    /// The only strategy, whatever A and B are: it is never changed and no other follows it. What it does not take is its
    /// InputError, what it cannot factor its NumericalError.
    std::optional<ContactStrategy> always = {};
    /// Not taken, neither at first nor later nor as a fall-back. `prepare` throws InputError if that leaves nothing for A and
    /// B; what it leaves is tried in turn.
    std::vector<ContactStrategy> never = {};
    /// Sparse matrices up to so many unknowns are treated as dense.
    Index small = 300;
    /// Condition of A (scaled to unit diagonal) up to which some 20 sweeps or steps of CG reach rounding: less than a
    /// factor's back-substitutions cost.
    double well_conditioned = 20;
    /// The same for bounds, whose sweeps are cheaper: some 100 of them still beat a factor and its growing pool.
    double sweepable = 100;
    /// The same where a factor of A is no larger than A: bars, strings, strips.
    double sweepable_if_narrow = 3;
    /// Solves with one A before its factor pays; one more for every 16 rows that were in contact meanwhile.
    int solves_before_factor = 20;
};

/// The chooser. In this order, for symmetric A:
///   diagonal, rows that do not overlap                -> DiagonalContact
///   singular or nearly so (a body nothing holds)      -> FloatingContact
///   dense or diagonal, or few unknowns                -> DenseContact (few unknowns with any number of rows)
///   bounds, condition up to `sweepable`               -> ColourSor (up to `sweepable_if_narrow` where A is a narrow band)
///   well conditioned, rows that do not overlap        -> ProjectedCg, if a factor would cost more
///   M-matrix and bounds, not a narrow band            -> MultigridActiveSet
///   overlapping rows, a quarter as many as unknowns   -> InteriorPoint
///   else                                              -> SchurContact
/// or, where the options forbid it, KluActiveSet, InteriorPoint, OrthogonalContact, PrincipalPivoting, FloatingContact;
/// and KluActiveSet, then PrincipalPivoting, for A that is not symmetric; KluActiveSet too where many bounds of a narrow band
/// close, more than a pool should hold. A whose factor shows that it is singular, or nearly so: FloatingContact.
///
/// Rows that equal another one up to a positive factor are merged with it first (contact/prepare/merged_rows.hpp).
/// All of them work in a numbering by waves where the caller's is as good as random (contact/prepare/renumbered.hpp).
/// The choice is looked at again after every solve, on counts only, so that a run can be repeated to the last bit:
/// multigrid makes way for SchurContact when the same A has been asked for often and contact hardly touches new rows, and
/// any iteration does so when it was far slower than usual, or failed, three times in a row. ContactReport::reason says why
/// the strategy was taken.
/// A strategy that ends without a solution is followed by SchurContact, by FloatingContact and, up to 4000 unknowns, by
/// OrthogonalContact, which also has the last word on infeasibility, then by InteriorPoint; the report names the first and the
/// last. Rows with two intervals go through IntervalContact (contact/prepare/interval_contact.hpp).
class AutomaticContact final : public ContactSolver {
public:
    using Options = AutomaticOptions;
    explicit AutomaticContact(Options options = {}) : options_(std::move(options)) {}
    std::unique_ptr<PreparedContact> prepare(const Matrix& A, const Matrix& B) const override;
    std::unique_ptr<PreparedContact> prepare_rows(const Matrix& A, const Matrix& B) const override;

private:
    Options options_;
};

}  // namespace tact
