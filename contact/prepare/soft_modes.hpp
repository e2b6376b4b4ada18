// The directions in which a symmetric positive semidefinite matrix is soft, and a factor of what is stiff in it.
#pragma once

#include <memory>
#include <vector>

#include "../../lib/algebra/linear_solver.hpp"

namespace tact {

/// A block elimination of A in which nothing cancels, however soft A is. In unknowns of unit stiffness, u = unit x, let E
/// be a few unknowns that, held, leave nothing soft (the six of a rigid body, one of a spring that is not tied to
/// anything, unknowns without stiffness), and F the others. Then
///   A x = f   <=>   x = P f + R t,  diag(stiffness) t = R'f,   P = [A_FF^-1 0; 0 0],
/// with R (n x k, A R = 0 on F) found to machine precision by refinement in twice the working precision, and stiffness =
/// R'A R diagonal, taken in twice the precision too. A mode whose stiffness is below the rounding of A's own entries,
/// 4 eps |R|'|A||R|, costs nothing: its stiffness is zero, and it is one of the first `free` ones.
/// E is found by pivots for up to 500 unknowns or a dense A, else from unknowns far apart on the graph of A and by inverse
/// iteration; more unknowns than needed do no harm. Needs no coordinates.
class SoftModes {
public:
    /// `last`: unknowns on which compliances are asked for. NumericalError if A is indefinite, or has more soft modes than
    /// a dense block of them is for (2,000).
    SoftModes(const Matrix& A, const Matrix& B, const std::vector<Index>& last);
    SoftModes(SoftModes&&) noexcept;
    ~SoftModes();

    const Vector& unit() const { return unit_; }
    const Matrix& A() const { return A_; }       ///< in unknowns of unit stiffness
    const DenseMatrix& R() const { return R_; }  ///< n x k
    const Vector& stiffness() const { return stiffness_; }
    /// R'A R of the free modes: what A's rounding has left of it.
    const Vector& faint() const { return faint_; }
    Index free() const { return free_; }
    /// x := P x.
    void solve(Eigen::Ref<DenseMatrix> x) const;
    /// S(i, j) := r_i' P r_j for the columns r of Q, i <= j, j from `first` on.
    void compliance(const SparseMatrix& Q, Index first, DenseMatrix& S) const;

private:
    void find_pinned(const std::vector<Index>& last);
    void factor(const std::vector<Index>& last, double shift);
    /// Directions of A_FF that are softer than `soft`, by inverse iteration; on all n unknowns.
    DenseMatrix softest(double soft, double none);
    void pin(const DenseMatrix& modes);
    void keep_soft_ones();
    void refine();
    void sort_by_stiffness();
    DenseMatrix times_A(const DenseMatrix& X) const;

    Vector unit_;
    Matrix A_;
    std::vector<Index> pinned_, others_, place_;  // E, F, and where an unknown is in F; -1 in E
    std::unique_ptr<const Factor> factor_;        // of A_FF
    DenseMatrix held_, held_stiffness_;           // R and R'A R of pinned unknowns that were not soft: part of P
    DenseMatrix R_;
    Vector stiffness_, faint_;
    Index free_ = 0;
};

}  // namespace tact
