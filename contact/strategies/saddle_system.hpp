// The quasi-definite system of an interior point or of a set of equations.
#pragma once

#include <Eigen/SparseCholesky>
#include <vector>

#include "../../lib/problem/matrix.hpp"

namespace tact {

/// [A + diag(d)  C'; C  -diag(theta)] (x; -y) = (f; g): one pattern, any d >= 0 and theta >= 0, by L D L' with a fill-
/// reducing order and iterative refinement. C: rows by column (C'), A: symmetric positive definite with unit diagonal.
/// R. J. Vanderbei, Symmetric quasidefinite matrices, SIAM J. Optim. 5 (1995).
class SaddleSystem {
public:
    /// `regularisation`, of unit stiffness and unit rows, is undone by the refinement: large enough for dependent rows of C,
    /// small enough for few rounds.
    SaddleSystem(const SparseMatrix& A, const SparseMatrix& Ct, double regularisation);
    /// false if a pivot vanishes.
    [[nodiscard]] bool factor(const Vector& d, const Vector& theta);
    /// Overwrites f with x and g with y.
    void solve(Vector& f, Vector& g);

private:
    Index n_, k_;
    double regularisation_;
    SparseMatrix K_;  // the lower triangle
    std::vector<SparseMatrix::StorageIndex> diagonal_;
    Vector unshifted_;  // K's diagonal without d and theta
    Vector exact_;      // and with them, without regularisation
    Eigen::SimplicialLDLT<SparseMatrix, Eigen::Lower, Eigen::AMDOrdering<long>> ldlt_;
    Vector x_, r_;
};

}  // namespace tact
