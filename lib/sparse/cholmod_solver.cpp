#include "cholmod_solver.hpp"

#include <cholmod.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "../errors.hpp"
#include "band_factor.hpp"
#include "compliance.hpp"
#include "numbering.hpp"
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

/// Nested dissection by METIS, on the graph of the nodes: five times cheaper than on that of the unknowns, and as good.
/// METIS draws from a generator that CHOLMOD leaves at its fixed seed. Empty if it fails.
std::vector<long> nested_dissection(const SparseMatrix& A, cholmod_common& common) {
    const Index size = unknowns_of_a_node(A), nodes = A.cols() / size;
    std::vector<long> start{0}, rows;
    std::vector<Index> seen(static_cast<std::size_t>(nodes), -1);
    for (Index node = 0; node < nodes; ++node) {
        const auto first = rows.size();
        for (auto k = A.outerIndexPtr()[node * size]; k < A.outerIndexPtr()[(node + 1) * size]; ++k) {
            const Index row = A.innerIndexPtr()[k] / size;
            if (row < node || seen[static_cast<std::size_t>(row)] == node) continue;
            seen[static_cast<std::size_t>(row)] = node;
            rows.push_back(row);
        }
        std::sort(rows.begin() + static_cast<std::ptrdiff_t>(first), rows.end());
        start.push_back(static_cast<long>(rows.size()));
    }
    cholmod_sparse graph{};
    graph.nrow = graph.ncol = static_cast<std::size_t>(nodes);
    graph.nzmax = rows.size();
    graph.p = start.data();
    graph.i = rows.data();
    graph.stype = -1;
    graph.itype = CHOLMOD_LONG;
    graph.xtype = CHOLMOD_PATTERN;
    graph.dtype = CHOLMOD_DOUBLE;
    graph.sorted = 1;
    graph.packed = 1;
    std::vector<long> of_nodes(static_cast<std::size_t>(nodes)), order;
    if (!cholmod_l_metis(&graph, nullptr, 0, 0, of_nodes.data(), &common)) return {};
    order.reserve(static_cast<std::size_t>(A.cols()));
    for (const long node : of_nodes)
        for (Index k = 0; k < size; ++k) order.push_back(node * size + k);
    return order;
}

/// Puts the analysis into `library` that costs fewest operations: AMD's, or where a factor is dear that of nested
/// dissection. The unknowns of `last` come last.
void analyse(const SparseMatrix& A, const std::vector<Index>& last, Library& library) {
    constexpr double dear = 3e9;  // operations, some tenths of a second: an order by METIS costs a tenth of that
    cholmod_common& common = library.common;
    cholmod_sparse view = lower_view(A);
    const auto analyse_as = [&](std::vector<long>& order) {
        common.method[0].ordering = CHOLMOD_GIVEN;
        return cholmod_l_analyze_p(&view, order.data(), nullptr, 0, &common);
    };
    library.factor = cholmod_l_analyze(&view, &common);
    if (!library.factor) return;
    if (const double operations = common.fl; operations > dear) {
        std::vector<long> order = nested_dissection(A, common);
        cholmod_factor* other = order.empty() ? nullptr : analyse_as(order);
        if (other && common.fl < operations) std::swap(other, library.factor);
        cholmod_l_free_factor(&other, &common);
    }
    if (last.empty()) return;
    std::vector<char> at_end(static_cast<std::size_t>(A.cols()), 0);
    for (const Index i : last) at_end[static_cast<std::size_t>(i)] = 1;
    const long* permutation = static_cast<const long*>(library.factor->Perm);
    std::vector<long> order(permutation, permutation + A.cols());
    std::stable_partition(order.begin(), order.end(), [&](long i) { return !at_end[static_cast<std::size_t>(i)]; });
    cholmod_l_free_factor(&library.factor, &common);
    library.factor = analyse_as(order);
}

/// Of what the library has analysed.
SupernodalFactor factor_analysed(Library& library, cholmod_sparse& view, const std::string& name);

/// `name` is the matrix in messages.
SupernodalFactor factor_block(const SparseMatrix& block, const std::vector<Index>& last, const std::string& name) {
    Library library;
    cholmod_sparse view = lower_view(block);
    analyse(block, last, library);
    return factor_analysed(library, view, name);
}

/// The ordering and the symbolic analysis of one pattern, for many factors.
class Analysis {
public:
    Analysis(const SparseMatrix& block, const std::vector<Index>& last) : pattern_(block) {
        analyse(block, last, library_);
    }
    bool fits(const SparseMatrix& block) const {
        return block.rows() == pattern_.rows() && block.nonZeros() == pattern_.nonZeros() &&
               std::equal(block.outerIndexPtr(), block.outerIndexPtr() + block.cols() + 1,
                          pattern_.outerIndexPtr()) &&
               std::equal(block.innerIndexPtr(), block.innerIndexPtr() + block.nonZeros(), pattern_.innerIndexPtr());
    }
    SupernodalFactor factor(const SparseMatrix& block, const std::string& name) {
        Library numeric;
        cholmod_sparse view = lower_view(block);
        numeric.factor = library_.factor ? cholmod_l_copy_factor(library_.factor, &numeric.common) : nullptr;
        return factor_analysed(numeric, view, name);
    }

private:
    SparseMatrix pattern_;
    Library library_;
};

SupernodalFactor factor_analysed(Library& library, cholmod_sparse& view, const std::string& name) {
    cholmod_common& common = library.common;
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

std::string name_of(const SparseMatrix& A) {
    return "the " + std::to_string(A.rows()) + "x" + std::to_string(A.cols()) + " sparse matrix";
}

/// One Cholesky factor for each of `blocks` equal blocks on the diagonal.
class BlockFactor : public Factor {
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

/// With CHOLMOD's analysis kept, for other numbers on the same pattern.
class CholmodFactor final : public BlockFactor {
public:
    /// `last`: unknowns that come last in the order; none where there are several blocks.
    CholmodFactor(const SparseMatrix& A, Index blocks, std::vector<Index> last)
        : BlockFactor(factor_block(first_block(A, blocks), last, name_of(A)), blocks), last_(std::move(last)) {}
    CholmodFactor(const SparseMatrix& A, Index blocks, std::vector<Index> last, std::shared_ptr<Analysis> analysis)
        : BlockFactor(analysis->factor(first_block(A, blocks), name_of(A)), blocks),
          last_(std::move(last)),
          analysis_(std::move(analysis)) {}

    /// The first time the analysis is made, which then serves all that follow.
    std::unique_ptr<const Factor> refactorized(const Matrix& A) const override {
        const SparseMatrix* S = A.sparse();
        if (!S || !A.is_symmetric() || S->rows() == 0) return nullptr;
        const Index blocks = last_.empty() ? identical_blocks(*S) : 1;
        const SparseMatrix block = first_block(*S, blocks);
        if (!analysis_ || !analysis_->fits(block)) analysis_ = std::make_shared<Analysis>(block, last_);
        return std::make_unique<CholmodFactor>(*S, blocks, last_, analysis_);
    }

private:
    static SparseMatrix first_block(const SparseMatrix& A, Index blocks) {
        return A.topLeftCorner(A.rows() / blocks, A.cols() / blocks);
    }
    std::vector<Index> last_;
    mutable std::shared_ptr<Analysis> analysis_;
};

class NarrowFactor final : public Factor {
public:
    explicit NarrowFactor(const SparseMatrix& A) : factor_(A, name_of(A)) {}
    Index size() const override { return factor_.size(); }
    void solve(Eigen::Ref<DenseMatrix> B) const override {
        for (Index j = 0; j < B.cols(); ++j) factor_.solve(B.col(j).data());
    }

private:
    BandFactor factor_;
};

std::unique_ptr<const Factor> factor_of(const SparseMatrix& A, const std::vector<Index>& last) {
    if (BandFactor::half_width(A) <= BandFactor::widest) return std::make_unique<NarrowFactor>(A);
    const Index blocks = identical_blocks(A);
    return std::make_unique<CholmodFactor>(A, blocks, blocks == 1 ? last : std::vector<Index>{});
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
    if (const SparseMatrix* S = A.sparse()) return factor_of(*S, last_);
    return factor_of(A.to_sparse(), last_);
}

}  // namespace tact
