#include "cholmod_solver.hpp"

#include <cholmod.h>

#include <algorithm>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "../errors.hpp"
#include "band_factor.hpp"
#include "compliance.hpp"
#include "supernodal_factor.hpp"

namespace tact {
namespace {

/// Owns the library's settings, its work space and one factor, until that has been read out.
class Library {
public:
    Library() {
        cholmod_l_start(&common);
        common.print = 0;
        common.supernodal = CHOLMOD_SUPERNODAL;
        // METIS does not pay on these meshes: AMD alone.
        common.nmethods = 1;
        common.method[0].ordering = CHOLMOD_AMD;
    }
    ~Library() {
        cholmod_l_free_factor(&factor, &common);
        cholmod_l_finish(&common);
    }
    Library(const Library&) = delete;
    Library& operator=(const Library&) = delete;

    cholmod_common common{};
    cholmod_factor* factor = nullptr;
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

/// `name` is the matrix in messages.
SupernodalFactor factor_block(const SparseMatrix& block, const std::string& name) {
    Library library;
    cholmod_common& common = library.common;
    cholmod_sparse view = lower_view(block);
    library.factor = cholmod_l_analyze(&view, &common);
    if (library.factor) cholmod_l_factorize(&view, library.factor, &common);
    const cholmod_factor* L = library.factor;
    if (!L || common.status < CHOLMOD_OK)
        throw NumericalError("CHOLMOD: factoring " + name + " failed with status " + std::to_string(common.status));
    if (common.status == CHOLMOD_NOT_POSDEF || L->minor < L->n)
        throw NumericalError("CHOLMOD: " + name + " is singular or not positive definite (pivot " +
                             std::to_string(L->minor) + ")");
    // A pivot at rounding level of the largest is a floating body that slipped through.
    const double rcond = cholmod_l_rcond(library.factor, &common);
    if (!(rcond > 1e-15)) {
        std::ostringstream text;
        text << "CHOLMOD: " << name << " is singular to rounding (reciprocal condition " << rcond << ")";
        throw NumericalError(text.str());
    }
    return SupernodalFactor({.n = static_cast<Index>(L->n),
                             .supernodes = static_cast<Index>(L->nsuper),
                             .super = static_cast<const long*>(L->super),
                             .row_begin = static_cast<const long*>(L->pi),
                             .value_begin = static_cast<const long*>(L->px),
                             .rows = static_cast<const long*>(L->s),
                             .values = static_cast<const double*>(L->x),
                             .permutation = static_cast<const long*>(L->Perm)});
}

class BlockFactor final : public Factor {
public:
    BlockFactor(SupernodalFactor factor, Index blocks)
        : blocks_(blocks), n_(factor.size()), factor_(std::move(factor)) {}

    Index size() const override { return blocks_ * n_; }

    /// The blocks of a column are right-hand sides of one factor. Those that repeat one before up to sign (forces between
    /// equal bodies) are solved once, those without an entry not at all.
    void solve(Eigen::Ref<DenseMatrix> B) const override {
        columns_.clear();
        repeated_.clear();
        for (Index j = 0; j < B.cols(); ++j) {
            const auto first = columns_.size();
            for (Index block = 0; block < blocks_; ++block) {
                double* x = B.col(j).data() + block * n_;
                if (blocks_ == 1 || !repeats_one_of(first, x)) columns_.push_back(x);
            }
        }
        factor_.solve(columns_);
        for (const auto& [x, from, sign] : repeated_)
            for (Index i = 0; i < n_; ++i) x[i] = sign * from[i];
    }

    void compliance(const SparseMatrix& R, Index first, Eigen::Ref<DenseMatrix> S) const override {
        if (!compliance_) compliance_.emplace(factor_, blocks_);
        compliance_->form(R, first, S);
    }

private:
    bool repeats_one_of(std::size_t first, double* x) const {
        if (std::all_of(x, x + n_, [](double entry) { return entry == 0; })) return true;
        for (auto k = first; k < columns_.size(); ++k)
            for (const double sign : {1.0, -1.0})
                if (std::equal(x, x + n_, columns_[k], [sign](double a, double b) { return a == sign * b; })) {
                    repeated_.push_back({x, columns_[k], sign});
                    return true;
                }
        return false;
    }

    struct Repeated {
        double* x;
        const double* from;
        double sign;
    };
    Index blocks_;
    Index n_;
    SupernodalFactor factor_;
    mutable std::vector<double*> columns_;
    mutable std::vector<Repeated> repeated_;
    mutable std::optional<Compliance> compliance_;
};

class NarrowFactor final : public Factor {
public:
    explicit NarrowFactor(const SparseMatrix& A)
        : factor_(A, "the " + std::to_string(A.rows()) + "x" + std::to_string(A.cols()) + " sparse matrix") {}
    Index size() const override { return factor_.size(); }
    void solve(Eigen::Ref<DenseMatrix> B) const override {
        for (Index j = 0; j < B.cols(); ++j) factor_.solve(B.col(j).data());
    }

private:
    BandFactor factor_;
};

std::unique_ptr<const Factor> factor_of(const SparseMatrix& A) {
    if (BandFactor::half_width(A) <= BandFactor::widest) return std::make_unique<NarrowFactor>(A);
    const Index blocks = identical_blocks(A), n = A.rows() / blocks;
    return factor_of_blocks(factor_block(A.topLeftCorner(n, n), "the " + std::to_string(A.rows()) + "x" +
                                                                    std::to_string(A.cols()) + " sparse matrix"),
                            blocks);
}

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

std::unique_ptr<const Factor> factor_of_blocks(SupernodalFactor factor, Index blocks) {
    return std::make_unique<BlockFactor>(std::move(factor), blocks);
}

std::unique_ptr<const Factor> CholmodSolver::factorize(const Matrix& A) const {
    if (A.rows() != A.cols() || A.rows() == 0)
        throw InputError("CholmodSolver: A is " + A.shape() + ", expected square and not empty");
    if (!A.is_symmetric()) throw InputError("CholmodSolver: A is " + A.shape() + " and not symmetric; use KluSolver");
    if (const SparseMatrix* S = A.sparse()) return factor_of(*S);
    return factor_of(A.to_sparse());
}

}  // namespace tact
