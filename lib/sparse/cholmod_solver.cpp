#include "tact/lib/sparse/cholmod_solver.hpp"

#include <cholmod.h>

#include <algorithm>
#include <string>
#include <vector>

#include "tact/lib/errors.hpp"

namespace tact {
namespace {

/// Owns the library's settings and work space; one per factor, so that factors do not share state.
class Common {
public:
    Common() {
        cholmod_l_start(&common_);
        common_.print = 0;
        common_.supernodal = CHOLMOD_SUPERNODAL;
        // METIS does not pay on these meshes: AMD alone.
        common_.nmethods = 1;
        common_.method[0].ordering = CHOLMOD_AMD;
    }
    ~Common() { cholmod_l_finish(&common_); }
    Common(const Common&) = delete;
    Common& operator=(const Common&) = delete;
    cholmod_common* operator&() { return &common_; }  // NOLINT: the library asks for the address at every call
    const cholmod_common* operator->() const { return &common_; }

private:
    cholmod_common common_{};
};

cholmod_sparse lower_view(const SparseMatrix& A) {
    cholmod_sparse view{};
    view.nrow = static_cast<std::size_t>(A.rows());
    view.ncol = static_cast<std::size_t>(A.cols());
    view.nzmax = static_cast<std::size_t>(A.nonZeros());
    view.p = const_cast<long*>(A.outerIndexPtr());
    view.i = const_cast<long*>(A.innerIndexPtr());
    view.x = const_cast<double*>(A.valuePtr());
    view.stype = -1;
    view.itype = CHOLMOD_LONG;
    view.xtype = CHOLMOD_REAL;
    view.dtype = CHOLMOD_DOUBLE;
    view.sorted = 1;
    view.packed = 1;
    return view;
}

class CholmodFactor final : public Factor {
public:
    CholmodFactor(const SparseMatrix& A, Index blocks) : blocks_(blocks), n_(A.rows() / blocks) {
        const SparseMatrix block = A.topLeftCorner(n_, n_);
        cholmod_sparse view = lower_view(block);
        factor_ = cholmod_l_analyze(&view, &common_);
        if (!factor_) fail("analysis");
        cholmod_l_factorize(&view, factor_, &common_);
        if (common_->status == CHOLMOD_NOT_POSDEF || factor_->minor < factor_->n) {
            const auto column = std::to_string(factor_->minor);
            release();
            throw NumericalError("CHOLMOD: the " + std::to_string(A.rows()) + "x" + std::to_string(A.cols()) +
                                 " sparse matrix is singular or not positive definite (pivot " + column + ")");
        }
        if (common_->status < CHOLMOD_OK) fail("factorisation");
        // A pivot at rounding level of the largest is a floating body that slipped through.
        const double rcond = cholmod_l_rcond(factor_, &common_);
        if (!(rcond > 1e-15)) {
            release();
            throw NumericalError("CHOLMOD: the " + std::to_string(A.rows()) + "x" + std::to_string(A.cols()) +
                                 " sparse matrix is singular to rounding (reciprocal condition " +
                                 std::to_string(rcond) + ")");
        }
    }
    ~CholmodFactor() override { release(); }
    CholmodFactor(const CholmodFactor&) = delete;
    CholmodFactor& operator=(const CholmodFactor&) = delete;

    Index size() const override { return blocks_ * n_; }

    void solve(Eigen::Ref<DenseMatrix> B) const override {
        if (B.outerStride() == B.rows() || B.cols() == 1) {
            // blocks side by side are the columns of one right-hand side
            solve_columns(B.data(), n_, blocks_ * B.cols());
        } else {
            for (Index j = 0; j < B.cols(); ++j) solve_columns(B.col(j).data(), n_, blocks_);
        }
    }

private:
    void solve_columns(double* data, Index leading, Index columns) const {
        cholmod_dense right{};
        right.nrow = static_cast<std::size_t>(n_);
        right.ncol = static_cast<std::size_t>(columns);
        right.d = static_cast<std::size_t>(leading);
        right.nzmax = right.d * right.ncol;
        right.x = data;
        right.xtype = CHOLMOD_REAL;
        right.dtype = CHOLMOD_DOUBLE;
        cholmod_l_solve2(CHOLMOD_A, factor_, &right, nullptr, &solution_, nullptr, &work1_, &work2_, &common_);
        if (common_->status < CHOLMOD_OK || !solution_)
            throw NumericalError("CHOLMOD: solve failed with status " + std::to_string(common_->status));
        std::copy_n(static_cast<const double*>(solution_->x), n_ * columns, data);
    }

    [[noreturn]] void fail(const char* where) {
        const auto status = std::to_string(common_->status);
        release();
        throw NumericalError(std::string("CHOLMOD: ") + where + " failed with status " + status);
    }

    void release() {
        cholmod_l_free_factor(&factor_, &common_);
        cholmod_l_free_dense(&solution_, &common_);
        cholmod_l_free_dense(&work1_, &common_);
        cholmod_l_free_dense(&work2_, &common_);
    }

    Index blocks_;
    Index n_;
    mutable Common common_;
    cholmod_factor* factor_ = nullptr;
    mutable cholmod_dense* solution_ = nullptr;
    mutable cholmod_dense* work1_ = nullptr;
    mutable cholmod_dense* work2_ = nullptr;
};

bool repeats(const SparseMatrix& A, Index size, Index count) {
    const auto* outer = A.outerIndexPtr();
    const auto* inner = A.innerIndexPtr();
    const double* value = A.valuePtr();
    for (Index block = 1; block < count; ++block)
        for (Index j = 0; j < size; ++j) {
            const auto first = outer[j], other = outer[block * size + j];
            const auto length = outer[j + 1] - first;
            if (outer[block * size + j + 1] - other != length) return false;
            for (long k = 0; k < length; ++k)
                if (inner[other + k] - block * size != inner[first + k] || value[other + k] != value[first + k])
                    return false;
        }
    return true;
}

}  // namespace

Index identical_blocks(const SparseMatrix& A) {
    // The first block ends at the first column which no entry of the columns before it reaches.
    const Index n = A.cols();
    Index reach = 0;
    for (Index j = 0; j < n; ++j) {
        if (j > reach) break;
        for (auto k = A.outerIndexPtr()[j]; k < A.outerIndexPtr()[j + 1]; ++k)
            reach = std::max<Index>(reach, A.innerIndexPtr()[k]);
    }
    const Index size = reach + 1;
    if (size >= n || n % size != 0 || !repeats(A, size, n / size)) return 1;
    return n / size;
}

std::unique_ptr<const Factor> CholmodSolver::factorize(const Matrix& A) const {
    if (A.rows() != A.cols() || A.rows() == 0)
        throw InputError("CholmodSolver: A is " + A.shape() + ", expected square and not empty");
    if (!A.is_symmetric()) throw InputError("CholmodSolver: A is " + A.shape() + " and not symmetric; use KluSolver");
    if (const SparseMatrix* S = A.sparse()) return std::make_unique<CholmodFactor>(*S, identical_blocks(*S));
    const SparseMatrix copy = A.to_sparse();
    return std::make_unique<CholmodFactor>(copy, identical_blocks(copy));
}

}  // namespace tact
