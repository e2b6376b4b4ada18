#include "tact/lib/linear_solver.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <utility>

#include "tact/lib/errors.hpp"

namespace tact {
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

template <class Decomposition> class DenseFactor final : public Factor {
public:
    explicit DenseFactor(Decomposition decomposition) : decomposition_(std::move(decomposition)) {}
    Index size() const override { return decomposition_.rows(); }
    void solve(Eigen::Ref<DenseMatrix> B) const override {
        if constexpr (requires { decomposition_.solveInPlace(B); })
            decomposition_.solveInPlace(B);
        else
            B = decomposition_.solve(B).eval();
    }

private:
    Decomposition decomposition_;
};

}  // namespace

std::unique_ptr<const Factor> DenseLinearSolver::factorize(const Matrix& A) const {
    if (A.rows() != A.cols()) throw InputError("DenseLinearSolver: A is " + A.shape() + ", expected square");
    if (const Vector* d = A.diagonal_entries()) return std::make_unique<DiagonalFactor>(*d);
    const DenseMatrix* dense = A.dense();
    if (!dense) throw InputError("DenseLinearSolver: A is " + A.shape() + ", expected dense or diagonal");
    if (A.is_symmetric()) {
        Eigen::LLT<DenseMatrix> llt(*dense);
        if (llt.info() == Eigen::Success && (llt.rcond() > 1e-16 || dense->rows() == 0))
            return std::make_unique<DenseFactor<Eigen::LLT<DenseMatrix>>>(std::move(llt));
    }
    Eigen::PartialPivLU<DenseMatrix> lu(*dense);
    if (dense->rows() > 0 && !(lu.rcond() > 1e-16))
        throw NumericalError("DenseLinearSolver: the " + A.shape() + " matrix is singular");
    return std::make_unique<DenseFactor<Eigen::PartialPivLU<DenseMatrix>>>(std::move(lu));
}

}  // namespace tact
