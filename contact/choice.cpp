#include "choice.hpp"

#include <algorithm>

#include "prepare/matrix_facts.hpp"
#include "prepare/pinned_unknowns.hpp"
#include "prepare/rows.hpp"
#include "strategy_table.hpp"

namespace tact {
namespace {

using Strategy = ContactStrategy;

constexpr Index largest_orthogonal = 4000;
/// Rows up to which pivots on a whole tableau are cheap.
constexpr Index largest_tableau = 500;
/// Rows that PrincipalPivoting takes at most.
constexpr Index largest_pivoting = 6000;
/// Rows up to which a singular A is left to a dense saddle at once, not after an iteration has failed.
constexpr Index few_rows_of_floating = 6000;
/// Rows of a pool behind a narrow band.
constexpr Index narrow_pool = 500;
/// Numbers in a dense B that few unknowns may have: five copies of them are 160 MB.
constexpr Index largest_dense_rows = 4000000;
/// Unknowns up to which CG has no chance: two plates of 1,600 each take 84 us a step with a factor, 650 with CG.
constexpr Index cheap_to_factor = 20000;

struct RowShape {
    bool bounds, disjoint;
};

RowShape shape_of(const Matrix& B) {
    if (const Vector* diagonal = B.diagonal_entries(); diagonal && (diagonal->array() != 0).all())
        return {true, true};
    const ConstraintRows rows(B);
    return {rows.bounds(), rows.disjoint()};
}

[[noreturn]] void nothing_left(const Matrix& A, const Matrix& B) {
    throw InputError("AutomaticContact: options.never leaves no strategy for A " + A.shape() + " and B " + B.shape());
}

/// Whether a constant vector shows it (a translation, where unknowns are displacements), or, for few unknowns, a pivot.
bool looks_singular(const Matrix& A, const Matrix& B, const AutomaticOptions& options) {
    if (A.diagonal_entries() || B.rows() > few_rows_of_floating || !(A.main_diagonal().array() > 0).all())
        return false;
    if (matrix_facts(A).condition_above > 1 / nearly_singular) return true;
    if (A.rows() > options.small) return false;
    const Vector unit = A.main_diagonal().cwiseSqrt().cwiseInverse();
    return !softest_pivots(unit.asDiagonal() * A.to_dense() * unit.asDiagonal(), nearly_singular).empty();
}

}  // namespace

bool allowed(const AutomaticOptions& options, Strategy strategy) {
    return std::find(options.never.begin(), options.never.end(), strategy) == options.never.end();
}

StrategyChoice first_choice(const Matrix& A, const Matrix& B, const AutomaticOptions& options) {
    const auto may = [&](Strategy strategy) { return allowed(options, strategy); };
    if (options.always) return {*options.always, "asked for by the options"};
    constexpr std::string_view left = "what the options leave";
    const bool pivots = may(Strategy::principal_pivoting) && B.rows() <= largest_pivoting;
    if (!A.is_symmetric()) {
        if (may(Strategy::klu_active_set)) return {Strategy::klu_active_set, "A is not symmetric"};
        if (pivots) return {Strategy::principal_pivoting, left};
        nothing_left(A, B);
    }
    if (const Vector* diagonal = A.diagonal_entries();
        diagonal && (diagonal->array() >= 0).all() && may(Strategy::diagonal) && shape_of(B).disjoint)
        return {Strategy::diagonal, "diagonal A, rows that do not overlap"};
    if (may(Strategy::floating) && looks_singular(A, B, options))
        return {Strategy::floating, "A is singular or nearly so"};
    const bool small = A.rows() <= options.small;
    if ((!A.sparse() || small) && B.rows() <= 4 * options.small && may(Strategy::dense))
        return {Strategy::dense, "small or dense"};
    if (small && B.rows() <= largest_dense_rows / A.rows() && may(Strategy::dense))
        return {Strategy::dense, "few unknowns, of whose many rows few can be held"};
    const RowShape rows = shape_of(B);
    const MatrixFacts facts = matrix_facts(A);
    const bool sor = rows.bounds && may(Strategy::colour_sor);
    const bool cg = rows.disjoint && A.rows() > cheap_to_factor && may(Strategy::projected_cg);
    if (sor && facts.well_conditioned(A, facts.narrow ? options.sweepable_if_narrow : options.sweepable))
        return {Strategy::colour_sor, "well-conditioned A, bounds"};
    if (cg && facts.well_conditioned(A, options.well_conditioned))
        return {Strategy::projected_cg, "well-conditioned A, rows that do not overlap"};
    if (B.rows() > 0 && rows.bounds && facts.m_matrix && facts.positive_diagonal && !facts.narrow &&
        may(Strategy::multigrid_active_set))
        return {Strategy::multigrid_active_set, "ill-conditioned M-matrix, bounds, few solves with it so far"};
    if (!small && !rows.bounds && !rows.disjoint && 4 * B.rows() >= A.rows() && facts.positive_diagonal &&
        may(Strategy::interior_point))
        return {Strategy::interior_point, "many rows that overlap"};
    if (may(Strategy::schur)) {
        // A narrow band is refactored for less than many rows of a pool cost.
        const bool front = facts.narrow && rows.bounds && B.rows() > 4 * narrow_pool && may(Strategy::klu_active_set);
        return {Strategy::schur, "one factor of A for all solves", front ? narrow_pool : 0};
    }
    if (may(Strategy::klu_active_set)) return {Strategy::klu_active_set, left};
    if (may(Strategy::interior_point) && facts.positive_diagonal) return {Strategy::interior_point, left};
    if (may(Strategy::orthogonal) && A.rows() <= largest_orthogonal) return {Strategy::orthogonal, left};
    if (pivots) return {Strategy::principal_pivoting, left};
    if (may(Strategy::floating)) return {Strategy::floating, left};
    nothing_left(A, B);
}

std::vector<Strategy> followers(const StrategyChoice& first, const Matrix& A, const Matrix& B,
                                const AutomaticOptions& options) {
    std::vector<Strategy> rest;
    const auto add = [&](Strategy strategy) {
        if (strategy != first.strategy && allowed(options, strategy)) rest.push_back(strategy);
    };
    if (options.always) return rest;
    if (!A.is_symmetric()) {
        if (B.rows() > 0 && B.rows() <= largest_orthogonal) add(Strategy::principal_pivoting);
        return rest;
    }
    const bool medium = A.rows() <= largest_orthogonal;
    if (first.pool_rows > 0) add(Strategy::klu_active_set);
    if (facts_of(first.strategy).patience > 0 || !medium) add(Strategy::schur);
    add(Strategy::floating);
    if (medium) add(Strategy::orthogonal);
    if ((A.main_diagonal().array() > 0).all()) add(Strategy::interior_point);
    if (medium && B.rows() > 0 && B.rows() <= largest_tableau) add(Strategy::principal_pivoting);
    return rest;
}

}  // namespace tact
