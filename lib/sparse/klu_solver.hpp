// KLU: sparse LU for matrices that are not symmetric, and for one fixed pattern whose values change.
#pragma once

#include "../algebra/linear_solver.hpp"

namespace tact {

/// Sparse LU with partial pivoting. NumericalError if A is singular.
class KluSolver final : public LinearSolver {
public:
    std::unique_ptr<const Factor> factorize(const Matrix& A) const override;
};

/// One symbolic analysis for a pattern; its values may change and are refactored with the pivots found first. Falls
/// back to fresh pivots when those have become bad (reciprocal condition estimate), so it is safe for any values.
class KluRefactorable {
public:
    explicit KluRefactorable(SparseMatrix A);
    ~KluRefactorable();
    KluRefactorable(const KluRefactorable&) = delete;
    KluRefactorable& operator=(const KluRefactorable&) = delete;

    /// The values to change before refactor(), in the pattern's order.
    SparseMatrix& matrix() { return A_; }
    const SparseMatrix& matrix() const { return A_; }
    /// false if the matrix is singular with fresh pivots too.
    [[nodiscard]] bool refactor();
    /// B := A^-1 B, and B := A^-T B.
    void solve(Eigen::Ref<DenseMatrix> B) const;
    void solve_transposed(Eigen::Ref<DenseMatrix> B) const;
    /// Operations of the numeric factorisation at hand, and of a solve with it.
    double factor_cost() const;
    double solve_cost() const;
    long full_factorisations() const { return full_factorisations_; }

private:
    bool factor_anew();
    struct Library;
    SparseMatrix A_;
    std::unique_ptr<Library> klu_;
    long full_factorisations_ = 0;
};

/// The factor that KluSolver makes, with what only an LU factor can do.
class KluFactor final : public Factor {
public:
    /// NumericalError if A is singular.
    explicit KluFactor(const SparseMatrix& A);
    Index size() const override { return klu_.matrix().rows(); }
    void solve(Eigen::Ref<DenseMatrix> B) const override { klu_.solve(B); }
    void solve_transposed(Eigen::Ref<DenseMatrix> B) const { klu_.solve_transposed(B); }
    double factor_cost() const { return klu_.factor_cost(); }
    double solve_cost() const { return klu_.solve_cost(); }

private:
    KluRefactorable klu_;
};

}  // namespace tact
