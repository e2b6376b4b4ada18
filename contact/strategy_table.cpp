#include "strategy_table.hpp"

#include <algorithm>
#include <iterator>

#include "dense/dense_contact.hpp"
#include "dense/orthogonal_contact.hpp"
#include "strategies/colour_sor.hpp"
#include "strategies/diagonal_contact.hpp"
#include "strategies/floating_contact.hpp"
#include "strategies/interior_point.hpp"
#include "strategies/klu_active_set.hpp"
#include "strategies/multigrid_active_set.hpp"
#include "strategies/principal_pivoting.hpp"
#include "strategies/projected_cg.hpp"
#include "strategies/schur_contact.hpp"

namespace tact {
namespace {

template <class Recipe> std::unique_ptr<PreparedContact> prepare(const Matrix& A, const Matrix& B) {
    return Recipe().prepare(A, B);
}
std::unique_ptr<PreparedContact> prepare_schur(const Matrix& A, const Matrix& B) {
    return SchurContact({.least_stiffness = nearly_singular}).prepare(A, B);
}

using S = ContactStrategy;
using R = RowsTaken;

// strategy, name, rows, unsymmetric, semidefinite, patience, prepare
constexpr StrategyFacts table[] = {
    {S::diagonal, "diagonal", R::disjoint, false, true, 0, prepare<DiagonalContact>},
    {S::dense, "dense", R::any, false, false, 0, prepare<DenseContact>},
    {S::klu_active_set, "klu-active-set", R::any, true, false, 0, prepare<KluActiveSet>},
    {S::colour_sor, "colour-sor", R::bounds, false, false, 300, prepare<ColourSor>},
    {S::projected_cg, "projected-cg", R::disjoint, false, false, 40, prepare<ProjectedCg>},
    {S::multigrid_active_set, "multigrid", R::bounds, false, false, 60, prepare<MultigridActiveSet>},
    {S::schur, "schur", R::any, false, false, 0, prepare_schur},
    {S::floating, "floating", R::any, false, true, 0, prepare<FloatingContact>},
    {S::orthogonal, "orthogonal", R::any, false, false, 0, prepare<OrthogonalContact>},
    {S::interior_point, "interior-point", R::any, false, false, 0, prepare<InteriorPoint>},
    {S::principal_pivoting, "principal-pivoting", R::any, true, false, 0, prepare<PrincipalPivoting>},
};

}  // namespace

std::span<const StrategyFacts> strategy_table() { return table; }

const StrategyFacts& facts_of(ContactStrategy strategy) {
    return *std::ranges::find(table, strategy, &StrategyFacts::strategy);
}

}  // namespace tact
