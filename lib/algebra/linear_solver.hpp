// The seam to linear algebra: a recipe that factorises, and a factor that solves.
#pragma once

#include <memory>

#include "../problem/matrix.hpp"

namespace tact {

/// A factorisation of one matrix. A factor belongs to one thread at a time (it owns its work space).
class Factor {
public:
    virtual ~Factor() = default;
    virtual Index size() const = 0;
    /// B := A^-1 B in place, column by column; B has size() rows.
    virtual void solve(Eigen::Ref<DenseMatrix> B) const = 0;
    /// S(i, j) := r_i' A^-1 r_j for the columns r of R, i <= j, j from `first` on; R has size() rows, S at least as many
    /// rows and columns as R has columns.
    virtual void compliance(const SparseMatrix& R, Index first, Eigen::Ref<DenseMatrix> S) const;
    /// A factor of other numbers on the same pattern, which may share this one's ordering and symbolic analysis; nullptr where
    /// nothing can be shared: factorise anew. Throws as `factorize` does; this factor stays as it is.
    virtual std::unique_ptr<const Factor> refactorized(const Matrix& A) const;
};

/// A recipe for factorising. Throws NumericalError that names the matrix if it is singular (or, for a Cholesky
/// factor, not positive definite).
class LinearSolver {
public:
    virtual ~LinearSolver() = default;
    virtual std::unique_ptr<const Factor> factorize(const Matrix& A) const = 0;
};

/// Eigen's dense and diagonal factors: everything a reduced problem needs. Cholesky if A is symmetric
/// (NumericalError unless positive definite to rounding), else LU with partial pivoting. InputError on a sparse matrix.
class DenseLinearSolver final : public LinearSolver {
public:
    std::unique_ptr<const Factor> factorize(const Matrix& A) const override;
};

}  // namespace tact
