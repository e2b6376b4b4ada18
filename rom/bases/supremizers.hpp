// Supremizers: primal directions that answer to the dual basis.
#pragma once

#include <memory>

#include "../../lib/algebra/linear_solver.hpp"
#include "../../lib/problem/contact_problem.hpp"

namespace tact {

/// What of a primal basis is left to supremizers.
struct SupremizerOptions {
    double share = 0;                            ///< of p, 0 to less than 1; 0: none
    std::shared_ptr<const LinearSolver> linear;  ///< factorises A = a^2 M + a D + K
    double a = 0;                                ///< 3 / (2 dt) of a BDF2 march; 0: statics, A = K
};

/// n x at most `count`: A^-1 B'U_lambda, the displacements under unit multipliers of each dual vector, scaled to unit length. With as many as
/// dual vectors, these themselves; with fewer, the leading left singular vectors of them. Zero ones are left out. With
/// the exact ones in U, B_r has full row rank wherever B'U_lambda has full column rank
/// (Rozza, Veroy, Comput. Methods Appl. Mech. Eng. 196, 2007). InputError if U_lambda does not fit or there is no
/// linear solver; NumericalError if A is singular.
DenseMatrix supremizers(const ContactProblem& problem, const DenseMatrix& U_lambda, Index count,
                        const SupremizerOptions& options);

}  // namespace tact
