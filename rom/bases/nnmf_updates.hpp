// The three ways to better one factor of a non-negative factorisation while the other one is held.
#pragma once

#include "../../lib/types.hpp"

namespace tact {

/// Each lowers |T - F'G| over F >= 0 given P = G T' and S = G G', or leaves it.
enum class NnmfUpdates {
    hierarchical,    ///< one row of F after the other, exactly (Cichocki, Phan, IEICE Trans. E92-A, 2009)
    multiplicative,  ///< F_ij P_ij / (S F)_ij: zeros stay (Lee, Seung, NIPS 13, 2001)
    least_squares  ///< all of F at its minimum, which may leave vectors unused (Kim, Park, SIAM J. Matrix Anal. 30, 2008)
};

/// F: k x columns of T. `sweeps` repetitions, of which least_squares needs one.
void update_factor(NnmfUpdates updates, DenseMatrix& F, const DenseMatrix& P, const DenseMatrix& S, int sweeps);

}  // namespace tact
