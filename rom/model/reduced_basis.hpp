// The pair of bases a reduced problem is made with.
#pragma once

#include "../../lib/problem/contact_problem.hpp"

namespace tact {

/// What a dual basis may hold: `any` is for experiments such as a dual basis by singular vectors, where lambda >= 0 is lost.
enum class DualSigns { non_negative, any };

/// u ~ U q,  lambda ~ U_lambda s with s >= 0  (Balajewicz, Amsallem, Farhat, eq. 6).
struct ReducedBasis {
    DenseMatrix U;         ///< n x p, the primal basis
    DenseMatrix U_lambda;  ///< m x p_lambda, the dual basis, >= 0 entrywise; no columns: a scene that never touches
    DualSigns signs = DualSigns::non_negative;

    Index primal_size() const { return U.cols(); }
    Index dual_size() const { return U_lambda.cols(); }
};

/// InputError unless both bases fit the problem, U has a column, all entries are finite and, unless `signs` says any, no
/// entry of U_lambda is negative (its row, column and value are named).
void validate(const ReducedBasis& basis, const ContactProblem& problem);

/// The same span in coordinates in which a reduced step costs no factorisation: U'MU = I and U'KU diagonal, ascending,
/// from the generalised eigenproblem in the orthonormalised span. Where M is absent, D takes its place if it is
/// symmetric and positive definite; in statics U'U = I. Columns of U that depend on earlier ones to 1e-12 are
/// dropped; signs are fixed. U_lambda stays as it is. Where these matrices are not symmetric, or the first is not
/// positive definite in the span, U is orthonormalised only.
ReducedBasis modal_basis(const ContactProblem& problem, const ReducedBasis& basis);

/// U q and U_lambda s.
Vector lift(const ReducedBasis& basis, const ConstVectorRef& q);
Vector lift_multipliers(const ReducedBasis& basis, const ConstVectorRef& s);

}  // namespace tact
