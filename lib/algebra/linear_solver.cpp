#include "linear_solver.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <limits>
#include <utility>

#include "../errors.hpp"

namespace tact {

void Factor::compliance(const SparseMatrix& R, Index first, Eigen::Ref<DenseMatrix> S) const {
    constexpr Index batch = 32;  // right-hand sides that fill a solve
    for (Index j = first; j < R.cols(); j += batch) {
        const Index count = std::min(batch, R.cols() - j);
        DenseMatrix X = R.middleCols(j, count);
        solve(X);
        for (Index k = 0; k < count; ++k)
            for (Index i = 0; i <= j + k; ++i) S(i, j + k) = R.col(i).dot(X.col(k));
    }
}

std::unique_ptr<const Factor> Factor::refactorized(const Matrix&) const { return nullptr; }

namespace {

class DiagonalFactor final : public Factor {
public:
    explicit DiagonalFactor(const Vector& d) : inverse_(d.cwiseInverse()) {
        if (!inverse_.allFinite()) throw NumericalError("DenseLinearSolver: the diagonal matrix is singular");
    }
    Index size() const override { return inverse_.size(); }
    void solve(Eigen::Ref<DenseMatrix> B) const override { B.array().colwise() *= inverse_.array(); }

private:
    Vector inverse_;
};

class CholeskyFactor final : public Factor {
public:
    explicit CholeskyFactor(Eigen::LLT<DenseMatrix> llt) : llt_(std::move(llt)) {}
    Index size() const override { return llt_.rows(); }
    void solve(Eigen::Ref<DenseMatrix> B) const override {
        // Column by column Eigen needs no work space; one is the case in every step.
        if (B.cols() == 0) return;
        if (B.cols() > 1) return llt_.solveInPlace(B);
        VectorRef b = B.col(0);
        llt_.solveInPlace(b);
    }

private:
    Eigen::LLT<DenseMatrix> llt_;
};

/// Whether no pivot has shrunk to rounding of its diagonal entry: independent of how the unknowns are scaled.
bool positive_definite(const Eigen::LLT<DenseMatrix>& llt, const DenseMatrix& A) {
    if (llt.info() != Eigen::Success) return false;
    const double rounding = static_cast<double>(A.rows()) * std::numeric_limits<double>::epsilon();
    return (llt.matrixLLT().diagonal().array().square() > rounding * A.diagonal().array()).all();
}

class LuFactor final : public Factor {
public:
    explicit LuFactor(Eigen::PartialPivLU<DenseMatrix> lu) : lu_(std::move(lu)), work_(lu_.rows()) {}
    Index size() const override { return lu_.rows(); }
    void solve(Eigen::Ref<DenseMatrix> B) const override {
        for (Index j = 0; j < B.cols(); ++j) {
            work_.noalias() = lu_.permutationP() * B.col(j);
            lu_.matrixLU().triangularView<Eigen::UnitLower>().solveInPlace(work_);
            lu_.matrixLU().triangularView<Eigen::Upper>().solveInPlace(work_);
            B.col(j) = work_;
        }
    }

private:
    Eigen::PartialPivLU<DenseMatrix> lu_;
    mutable Vector work_;
};

}  // namespace

std::unique_ptr<const Factor> DenseLinearSolver::factorize(const Matrix& A) const {
    if (A.rows() != A.cols()) throw InputError("DenseLinearSolver: A is " + A.shape() + ", expected square");
    if (const Vector* d = A.diagonal_entries()) return std::make_unique<DiagonalFactor>(*d);
    const DenseMatrix* dense = A.dense();
    if (!dense) throw InputError("DenseLinearSolver: A is " + A.shape() + ", expected dense or diagonal");
    if (A.is_symmetric()) {
        Eigen::LLT<DenseMatrix> llt(*dense);
        if (!positive_definite(llt, *dense))
            throw NumericalError("DenseLinearSolver: the " + A.shape() +
                                 " matrix is singular or not positive definite");
        return std::make_unique<CholeskyFactor>(std::move(llt));
    }
    Eigen::PartialPivLU<DenseMatrix> lu(*dense);
    if (dense->rows() > 0 && !(lu.rcond() > 1e-16))
        throw NumericalError("DenseLinearSolver: the " + A.shape() + " matrix is singular");
    return std::make_unique<LuFactor>(std::move(lu));
}

}  // namespace tact
