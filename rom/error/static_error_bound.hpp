// A proven bound of a static answer's error in the energy norm.
#pragma once

#include "../../lib/algebra/linear_solver.hpp"
#include "../../lib/problem/contact_family.hpp"
#include "../../lib/time/stage.hpp"
#include "../model/reduced_basis.hpp"

namespace tact {

/// What |u - U q|_K is at most, |x|_K^2 = x'K x, and what it is made of.
struct EnergyBound {
    double error = 0;        ///< the bound
    double residual = 0;     ///< |rho|_K, rho = U q - K^-1 (f + B'U_lambda s)
    double correction = 0;   ///< |z|_K, B (U q + z) >= c
    double gap = 0;          ///< s'U_lambda'(B (U q + z) - c) >= 0
    double penetration = 0;  ///< largest entry of c - B U q, or 0
};

/// For the solution u of  min 1/2 u'Ku - f'u, Bu >= c  and any q, s >= 0 and U_lambda >= 0:
///   |u - U q|_K <= |z - rho|_K / 2 + (|z + rho|_K^2 / 4 + s'U_lambda'(B (U q + z) - c))^(1/2)
/// for every z with B (U q + z) >= c: U q + z and U q - rho lie on the two sides of the duality gap, whose halves bound their
/// distances to u (the hypercircle of Prager and Synge, Quart. Appl. Math. 5, 1947). With |z - rho|, |z + rho| <= |z| + |rho|
/// it takes the form of the bound of Haasdonk, Salomon, Wohlmuth (SIAM J. Numer. Anal. 50, 2012); it is the error |rho| where
/// nothing is in contact. Here z is made of p_lambda lifts, the least in energy with B w_j >= 1 on the rows where U_lambda's
/// column j is the largest of its row and B w_j >= 0 elsewhere.
///
/// Holds up to rounding, about 1e-15 |u|_K. The stage of an implicit step is such a problem with its A for K.
class StaticErrorBound {
public:
    /// Solves p + 1 + p_lambda systems with K and p_lambda contact problems; holds B U and B W, m x (p + p_lambda). Only the
    /// gap of the family may depend on gamma. InputError unless it is static with a symmetric K and a constant gap and load
    /// and U_lambda >= 0; NumericalError if a lift does not exist (the rows exclude each other). Holds the family.
    StaticErrorBound(const Shared<ContactFamily>& family, const ReducedBasis& basis, const LinearSolver& linear,
                     const ContactWorkspace& contact);

    /// Evaluates c in all rows: of the full size, but one pass. Infinite where the lifts do not reach a row that is
    /// penetrated, and where U_lambda s presses on a row that is switched off. InputError if a size is wrong, s has a negative
    /// entry, or q, s or the gap a NaN.
    EnergyBound operator()(const Parameter& gamma, const ConstVectorRef& q, const ConstVectorRef& s) const;

private:
    void add_lifts(const ContactProblem& full, const ContactWorkspace& contact);
    void factor_energy(const ContactProblem& full, const DenseMatrix& X);

    Shared<ContactFamily> family_;
    std::vector<Index> rows_;     // all of them
    std::vector<Index> patch_;    // of each row: its lift, or -1
    std::vector<Index> touched_;  // the rows that have one
    DenseMatrix U_lambda_;        // on these
    DenseMatrix work_;            // U_lambda'B W
    DenseMatrix W_, B_U_, B_W_;
    DenseMatrix energy_;  // R with |X y|_K = |R y|, X = [U, K^-1 f, K^-1 B'U_lambda, W]
};

}  // namespace tact
