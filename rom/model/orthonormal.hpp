// Orthonormal columns and their signs: what every basis is finished with.
#pragma once

#include "../../lib/types.hpp"

namespace tact {

/// A column counts as dependent on those before it when what is left of it is below this fraction of its length.
inline constexpr double dependent_column = 1e-12;

/// Orthonormal columns with the span of X, in the order of X. A column that depends on earlier ones to within
/// `tolerance` of its own length (a zero column always) is dropped. Block Gram-Schmidt, twice: orthonormal to
/// rounding whatever the condition of X (Barlow, Smoktunowicz, Numer. Math. 123, 2013).
DenseMatrix orthonormal_columns(DenseMatrix X, double tolerance = dependent_column);

/// Turns each column so that its largest entry in magnitude is positive. Entries within 1e-8 of the largest count as
/// largest too and the first of them decides, so that rounding does not choose the sign of a symmetric mode.
void fix_signs(DenseMatrix& columns);

}  // namespace tact
