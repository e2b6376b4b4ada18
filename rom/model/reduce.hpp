// Galerkin projection of contact problems and of families of them.
#pragma once

#include <memory>

#include "../../lib/problem/contact_family.hpp"
#include "../../lib/shared.hpp"
#include "reduced_basis.hpp"

namespace tact {

/// Off-diagonal entries of a reduced matrix up to this fraction of sqrt(|d_i d_j|), or up to some 30 roundings of the
/// largest diagonal entry, are what rounding leaves of a modal basis: the matrix is then stored as a diagonal one, and
/// as the identity where its entries are within this of one.
inline constexpr double rounding_level = 1e-10;

/// M_r = U'MU (D, K alike), B_r = U_lambda' B U, c_r = U_lambda' c, f_r = U' f: again a contact problem, of sizes p and
/// p_lambda, that holds nothing of the full one but its coefficient functions (Balajewicz, Amsallem, Farhat, eq. 7).
/// Modes of c and f are projected one by one. u0 and v0 are projected in the inner product of M; where M is absent, of
/// D, or of K in statics; in the Euclidean one where that matrix is not symmetric positive definite. A row with
/// c = -infinity is off: InputError if U_lambda touches it. Costs products with the full matrices; the problem returned
/// never touches size n or m, unless there is an r: that is evaluated at U q. InputError as validate.
ContactProblem reduce(const ContactProblem& problem, const ReducedBasis& basis);

/// The reduced problems of a family. Where only the gap c depends on gamma (ContactFamily::varying), M, D, K, B, f, u0, v0
/// are projected at the centre of the box, once, and shared by all reduced problems; `at(gamma)` evaluates c on the rows
/// that U_lambda touches, and nothing else of the full size, and `gap` gives rows of c_r. Where other parts vary, `at` projects
/// the full problem each time (build_reduced_model.hpp does without). InputError if the family has parameters and a gap that
/// varies in time. The result holds the family.
std::unique_ptr<ContactFamily> reduce(const Shared<ContactFamily>& family, const ReducedBasis& basis);

/// Smallest over largest singular value of B_r: how far the reduced constraints are from dependent. 0 if p_lambda > p,
/// 1 without constraints.
double inf_sup_constant(const ContactProblem& reduced);

}  // namespace tact
