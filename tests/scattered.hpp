// Dense matrices without structure that need no random numbers.
#pragma once

#include <cmath>

#include "../lib/types.hpp"

namespace tact::testing {

/// Numbers in (-1, 1) that are the same everywhere.
inline DenseMatrix scattered(Index rows, Index cols, double seed = 1) {
    DenseMatrix X(rows, cols);
    for (Index j = 0; j < cols; ++j)
        for (Index i = 0; i < rows; ++i)
            X(i, j) =
                std::sin(seed * 12.9898 * static_cast<double>(i + 1) +
                         78.233 * static_cast<double>((j + 1) * (j + 3)) + static_cast<double>((i + 1) * (j + 1)));
    return X;
}

}  // namespace tact::testing
