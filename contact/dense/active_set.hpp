// The primal-dual active set on the condensed problem, with Goldfarb-Idnani when a set comes back.
#pragma once

#include <cstdint>
#include <vector>

#include "goldfarb_idnani.hpp"

namespace tact {

/// Solves  lambda >= 0,  w = S lambda - g >= 0,  lambda . w = 0  on the leading m x m block of S.
/// One iteration: S(C,C) lambda_C = g_C, then C := {lambda_i > 0 in C} + {w_i < 0 outside}. Exact on M-matrices and
/// in a few iterations; a set that comes back is noticed and handed to Goldfarb-Idnani, which is finite.
/// The factor is kept from one solve to the next and changed by the rows that come and go; it is made anew where it does not
/// solve its equations to rounding.
/// M. Hintermueller, K. Ito, K. Kunisch, SIAM J. Optim. 13 (2002) 865-888.
class CondensedActiveSet {
public:
    struct [[nodiscard]] Report {
        Outcome outcome = Outcome::converged;
        int iterations = 0;
        bool repeated = false;
    };
    /// As GoldfarbIdnani::solve. After the first solve: S is the one before on its leading rows, unless forget() was called.
    Report solve(const DenseMatrix& S, const ConstVectorRef& g, const ConstVectorRef& allowance, VectorRef lambda,
                 VectorRef w);
    void forget() { factor_.clear(); }
    const Vector& infeasibility() const { return exact_.infeasibility(); }

private:
    /// The multipliers of the factor's rows; whether they balance.
    bool solve_equations(const DenseMatrix& S, const ConstVectorRef& g, VectorRef w);
    /// w := S lambda - g for the multipliers of `rows`, and whether it is zero to rounding on them.
    bool balances(const DenseMatrix& S, const ConstVectorRef& g, const std::vector<Index>& rows, VectorRef w);
    /// lambda and the next set; whether it is the last.
    bool update(const DenseMatrix& S, const ConstVectorRef& allowance, const std::vector<Index>& rows,
                VectorRef lambda, VectorRef w);

    SchurFactor factor_;
    GoldfarbIdnani exact_;
    std::vector<Index> wanted_;
    std::vector<std::uint64_t> visited_;
    Vector multiplier_;
    double noise_ = 0;  // what the sum S lambda itself rounds to, in energy units
};

}  // namespace tact
