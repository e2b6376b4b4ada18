// The finite end of the chain where A is not symmetric: Murty's rule on the condensed problem.
#pragma once

#include "../../lib/contact_solver.hpp"

namespace tact {

/// S = B A^-1 B' dense from one KLU factor, then the linear complementarity problem by block principal pivoting (all wrong
/// rows change sides) while the number of wrong rows falls, and by Murty's least-index single pivots when it does not:
/// finite for every P-matrix, and S is one where A has a positive definite symmetric part and the rows of B are
/// independent. Dependent rows (an equality as two rows) make bases singular: up to 2000 rows Lemke's method finishes
/// then, and says infeasible with its certificate; beyond, Outcome::cycling. m^2 numbers: InputError above 6000 rows. K. G. Murty, Opsearch 11 (1974); J. J. Judice, F. M. Pires, Computers & OR 21 (1994).
class PrincipalPivoting final : public ContactSolver {
public:
    std::unique_ptr<PreparedContact> prepare(const Matrix& A, const Matrix& B) const override;
};

}  // namespace tact
