// KLU: sparse LU for matrices that are not symmetric, and for one fixed pattern whose values change.
#pragma once

#include <optional>
#include <utility>

#include "../algebra/linear_solver.hpp"
#include "supernodal_factor.hpp"

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
    explicit KluRefactorable(SparseMatrix A) : KluRefactorable(std::move(A), false) {}
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
    friend class KluFactor;
    /// symmetric: without row scaling and blocks, so that U = D L' where pivots are on the diagonal.
    KluRefactorable(SparseMatrix A, bool symmetric);
    /// P A P' = L L' in the form of a supernodal factor; nothing where that is not so.
    std::optional<SupernodalFactor> as_cholesky() const;
    bool factor_anew();
    struct Library;
    SparseMatrix A_;
    std::unique_ptr<Library> klu_;
    long full_factorisations_ = 0;
};

/// The factor that KluSolver makes, with what only an LU factor can do. Where A is said to be symmetric, and KLU finds every
/// pivot positive and on the diagonal, U = D L': L D^1/2 is then solved with as a Cholesky factor, at a fraction of the time.
class KluFactor final : public Factor {
public:
    /// NumericalError if A is singular.
    explicit KluFactor(const SparseMatrix& A, bool symmetric = false);
    ~KluFactor() override;
    Index size() const override { return n_; }
    void solve(Eigen::Ref<DenseMatrix> B) const override;
    void compliance(const SparseMatrix& R, Index first, Eigen::Ref<DenseMatrix> S) const override;
    void solve_transposed(Eigen::Ref<DenseMatrix> B) const;
    /// Operations of the factorisation, and of a solve with L and U.
    double factor_cost() const { return factor_cost_; }
    double solve_cost() const { return solve_cost_; }
    /// Whether solves are those of a Cholesky factor.
    bool symmetric() const { return symmetric_ != nullptr; }

private:
    Index n_;
    std::unique_ptr<KluRefactorable> klu_;  // one of the two
    std::unique_ptr<const Factor> symmetric_;
    double factor_cost_ = 0, solve_cost_ = 0;
};

}  // namespace tact
