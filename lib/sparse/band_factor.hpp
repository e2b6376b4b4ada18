// Cholesky factors of narrow bands, eliminated from both ends at once.
#pragma once

#include <string>
#include <vector>

#include "../types.hpp"

namespace tact {

/// A = P L D L' P' of a symmetric positive definite band (bars, strings, beams, anything numbered along a line) with the
/// order 0, n-1, 1, n-2, ... and the rows in the middle last: two recurrences that do not wait for each other, one in
/// each half of a register. n numbers and twice the band are read in a solve, where a supernodal factor has a
/// node for every few columns.
class BandFactor {
public:
    /// Entries below the diagonal are at most so far from it.
    static constexpr Index widest = 4;
    /// How far they are in A; n where that is more than `widest`, or where there are too few rows for two ends.
    static Index half_width(const SparseMatrix& A);

    /// A symmetric with half_width(A) <= widest; its lower half is read. NumericalError that calls it `name` unless it is
    /// positive definite, to rounding.
    BandFactor(const SparseMatrix& A, const std::string& name);

    Index size() const { return n_; }
    /// x := A^-1 x
    void solve(double* x) const;

private:
    typedef double Pair __attribute__((vector_size(16)));  // NOLINT: first end, last end

    template <Index width> void solve_width(double* x) const;
    void eliminate(const SparseMatrix& A, int end, DenseMatrix& middle, const std::string& name);

    Index n_, width_, ends_, middle_;  // rows eliminated from each end, and rows left between
    std::vector<Pair> lower_;          // width_ numbers a row: L(row, row - 1), ..., for ends_ + width_ rows
    std::vector<Pair> inverse_;        // 1 / D
    DenseMatrix root_;                 // Cholesky factor of the rows between
    mutable std::vector<Pair> work_;
};

}  // namespace tact
