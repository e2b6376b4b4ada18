// A cheap estimate of conditioning: what a chooser asks before it picks a solver.
#pragma once

#include "../problem/matrix.hpp"

namespace tact {

/// Extreme Ritz values of D^-1/2 A D^-1/2 (D the diagonal of A, which must be positive) after `steps` Lanczos steps
/// from a fixed start vector; the true spectrum contains them. A symmetric.
struct SpectrumEstimate {
    double smallest = 0;
    double largest = 0;
    /// Infinity if the smallest Ritz value is not positive.
    double condition() const;
};
SpectrumEstimate scaled_spectrum(const Matrix& A, int steps = 20);

}  // namespace tact
