// Lemke's complementary pivoting: the finite method for linear complementarity with a semidefinite matrix, symmetric or not.
#pragma once

#include <vector>

#include "../../lib/errors.hpp"
#include "../../lib/types.hpp"

namespace tact {

struct [[nodiscard]] LemkeReport {
    Outcome outcome = Outcome::converged;
    int pivots = 0;
    std::vector<char> basic;  ///< converged: rows whose lambda is basic; S among them is regular
    Vector ray;  ///< infeasible: y >= 0 along which the pivoting runs off, S y = 0 and g'y > 0 to rounding
};

/// Finds the rows in contact of  lambda >= 0,  w = S lambda - g >= 0,  lambda . w = 0  for S with x'Sx >= 0. Dependent
/// rows need no care: they stay out of the basis. Ties are broken lexicographically, so that no basis comes back. A dense
/// tableau: O(m^2) a pivot, 16 m^2 bytes. C. E. Lemke, Management Sci. 11 (1965); R. W. Cottle, J.-S. Pang, R. E. Stone,
/// The Linear Complementarity Problem (1992), 4.4 and 4.9.
LemkeReport lemke(const DenseMatrix& S, const ConstVectorRef& g);

}  // namespace tact
