// The primal-dual active set on the condensed problem, with Goldfarb-Idnani when a set comes back.
#pragma once

#include <cstdint>
#include <vector>

#include "tact/contact/dense/goldfarb_idnani.hpp"

namespace tact {

/// Solves  lambda >= 0,  w = S lambda - g >= 0,  lambda . w = 0  on the leading m x m block of S.
/// One iteration: S(C,C) lambda_C = g_C, then C := {lambda_i > 0 in C} + {w_i < 0 outside}. Exact on M-matrices and
/// in a few iterations; a set that comes back is noticed and handed to Goldfarb-Idnani, which is finite.
/// M. Hintermueller, K. Ito, K. Kunisch, SIAM J. Optim. 13 (2002) 865-888.
class CondensedActiveSet {
public:
    struct [[nodiscard]] Report {
        Outcome outcome = Outcome::converged;
        int iterations = 0;
        bool repeated = false;
    };
    /// As GoldfarbIdnani::solve.
    Report solve(const DenseMatrix& S, const ConstVectorRef& g, const ConstVectorRef& allowance, VectorRef lambda,
                 VectorRef w);
    const Vector& infeasibility() const { return exact_.infeasibility(); }

private:
    SchurFactor factor_;
    GoldfarbIdnani exact_;
    std::vector<Index> wanted_;
    std::vector<std::uint64_t> visited_;
    Vector multiplier_;
};

}  // namespace tact
