// Forces that only push, in balance with a load on a few modes.
#pragma once

#include <vector>

#include "../../lib/types.hpp"

namespace tact {

/// The nearest that forces lambda >= 0 on some rows come to a load: min |G'lambda - e| over lambda >= 0, for G with few
/// columns (modes) and rows of any size. Non-negative least squares by C. L. Lawson, R. J. Hanson, Solving Least Squares
/// Problems, Prentice-Hall, 1974, ch. 23: finite.
struct Balance {
    std::vector<Index> rows;  ///< with lambda > 0; their rows of G are independent
    Vector lambda;            ///< of these rows
    /// e - G'lambda. G rest <= 0: where it is not zero, -rest is a motion that no row stops, and the load drives it.
    Vector rest;
};
Balance balance(const DenseMatrix& G, const Vector& e);

/// More rows, until their rows of G together have full column rank; each the one that holds best what is not yet held.
/// False if no row holds some mode (beyond 1e-10 of the best held one).
[[nodiscard]] bool complete(const DenseMatrix& G, std::vector<Index>& rows);

}  // namespace tact
