// Least squares over the non-negative orthant, given by Gram matrices.
#pragma once

#include "../../lib/errors.hpp"
#include "../../lib/types.hpp"

namespace tact {

/// argmin |x - G'f|^2 over f >= 0, from S = G G' (k x k, semidefinite) and p = G x, starting at the f >= 0 given: its
/// KKT conditions are f >= 0, S f - p >= 0, f . (S f - p) = 0. The objective never rises. Rows of G that depend on those
/// in use stay out. Outcome iteration_limit leaves the best f reached. C. L. Lawson, R. J. Hanson, Solving Least Squares
/// Problems (1974), in the normal equations of R. Bro, S. de Jong, J. Chemometrics 11 (1997).
Outcome non_negative_least_squares(const DenseMatrix& S, const ConstVectorRef& p, VectorRef f);

}  // namespace tact
