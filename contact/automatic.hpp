// Picks a contact strategy from what A and B are.
#pragma once

#include "tact/lib/contact_solver.hpp"

namespace tact {

/// The chooser. In this order:
///   A dense or diagonal, or at most 300 unknowns, symmetric  -> DenseContact
///   A unsymmetric                                            -> KluActiveSet, then PrincipalPivoting
///   condition estimate <= 20 and bounds                      -> ColourSor
///   condition estimate <= 20 and rows that do not overlap    -> ProjectedCg
///   overlapping rows, at least a quarter as many as unknowns -> InteriorPoint
///   else                                                     -> SchurContact
/// A that is singular or indefinite to rounding     -> ProximalContact around SchurContact (or OrthogonalContact)
/// A strategy that ends without a solution is followed by SchurContact and, up to 4000 unknowns, by OrthogonalContact, which
/// also has the last word on infeasibility; the report names both. The estimate takes 20 Lanczos steps on A scaled to unit
/// diagonal.
class AutomaticContact final : public ContactSolver {
public:
    std::unique_ptr<PreparedContact> prepare(const Matrix& A, const Matrix& B) const override;
};

}  // namespace tact
