#include "klu_solver.hpp"

#include <klu.h>

#include <cmath>
#include <string>
#include <vector>

#include "../errors.hpp"
#include "band_factor.hpp"
#include "cholmod_solver.hpp"

namespace tact {

struct KluRefactorable::Library {
    Library() {
        klu_l_defaults(&common);
        common.halt_if_singular = 1;
    }
    ~Library() {
        klu_l_free_numeric(&numeric, &common);
        klu_l_free_symbolic(&symbolic, &common);
    }
    Library(const Library&) = delete;
    Library& operator=(const Library&) = delete;
    mutable klu_l_common common{};
    klu_l_symbolic* symbolic = nullptr;
    klu_l_numeric* numeric = nullptr;
};

KluRefactorable::KluRefactorable(SparseMatrix A, bool symmetric)
    : A_(std::move(A)), klu_(std::make_unique<Library>()) {
    A_.makeCompressed();
    if (symmetric) {
        klu_->common.btf = 0;
        klu_->common.scale = 0;
    }
    klu_->symbolic = klu_l_analyze(A_.rows(), A_.outerIndexPtr(), A_.innerIndexPtr(), &klu_->common);
    if (!klu_->symbolic)
        throw NumericalError("KLU: the analysis of a " + std::to_string(A_.rows()) + "x" + std::to_string(A_.cols()) +
                             " matrix failed with status " + std::to_string(klu_->common.status));
}

KluRefactorable::~KluRefactorable() = default;

bool KluRefactorable::factor_anew() {
    ++full_factorisations_;
    klu_l_free_numeric(&klu_->numeric, &klu_->common);
    klu_->numeric =
        klu_l_factor(A_.outerIndexPtr(), A_.innerIndexPtr(), A_.valuePtr(), klu_->symbolic, &klu_->common);
    if (!klu_->numeric) return false;
    klu_l_rcond(klu_->symbolic, klu_->numeric, &klu_->common);
    return klu_->common.rcond > 1e-15;
}

bool KluRefactorable::refactor() {
    if (!klu_->numeric) return factor_anew();
    const auto ok = klu_l_refactor(A_.outerIndexPtr(), A_.innerIndexPtr(), A_.valuePtr(), klu_->symbolic,
                                   klu_->numeric, &klu_->common);
    if (ok && klu_->common.status == KLU_OK) {
        klu_l_rgrowth(A_.outerIndexPtr(), A_.innerIndexPtr(), A_.valuePtr(), klu_->symbolic, klu_->numeric,
                      &klu_->common);
        // Pivots chosen for other values: keep them only while the elements have not grown.
        if (klu_->common.rgrowth > 1e-4) return true;
    }
    return factor_anew();
}

void KluRefactorable::solve(Eigen::Ref<DenseMatrix> B) const {
    // KLU takes four right-hand sides at a time through the factor.
    klu_l_solve(klu_->symbolic, klu_->numeric, B.outerStride(), B.cols(), B.data(), &klu_->common);
}

void KluRefactorable::solve_transposed(Eigen::Ref<DenseMatrix> B) const {
    klu_l_tsolve(klu_->symbolic, klu_->numeric, B.outerStride(), B.cols(), B.data(), &klu_->common);
}

double KluRefactorable::factor_cost() const {
    klu_l_flops(klu_->symbolic, klu_->numeric, &klu_->common);
    return klu_->common.flops;
}

double KluRefactorable::solve_cost() const {
    return 2 * static_cast<double>(klu_->numeric->lnz + klu_->numeric->unz + klu_->numeric->nzoff);
}

std::optional<SupernodalFactor> KluRefactorable::as_cholesky() const {
    const long n = A_.rows();
    klu_l_numeric* numeric = klu_->numeric;
    if (numeric->nzoff > 0 || !klu_l_sort(klu_->symbolic, numeric, &klu_->common)) return std::nullopt;
    const auto size = [](long k) { return static_cast<std::size_t>(k); };
    std::vector<long> Lp(size(n) + 1), Li(size(numeric->lnz)), Up(size(n) + 1), Ui(size(numeric->unz)), P(size(n)),
        Q(size(n));
    std::vector<double> Lx(Li.size()), Ux(Ui.size());
    if (!klu_l_extract(numeric, klu_->symbolic, Lp.data(), Li.data(), Lx.data(), Up.data(), Ui.data(), Ux.data(),
                       nullptr, nullptr, nullptr, P.data(), Q.data(), nullptr, nullptr, &klu_->common) ||
        P != Q || Li.size() != Ui.size())
        return std::nullopt;
    // The diagonal of U is last in its column, that of L first.
    std::vector<double> root(size(n));
    for (long j = 0; j < n; ++j) {
        const double pivot = Ux[size(Up[size(j) + 1] - 1)];
        if (!(pivot > 0) || Ui[size(Up[size(j) + 1] - 1)] != j || Li[size(Lp[size(j)])] != j) return std::nullopt;
        root[size(j)] = std::sqrt(pivot);
    }
    // Columns that follow each other up the elimination tree with one row less each time are one supernode.
    std::vector<long> super, row_begin, value_begin, rows;
    std::vector<double> values;
    for (long first = 0, next = 0; first < n; first = next) {
        const long begin = Lp[size(first)], count = Lp[size(first) + 1] - begin;
        for (next = first + 1; next < n && Lp[size(next) + 1] - Lp[size(next)] == count - (next - first) &&
                               Li[size(begin + next - first)] == next;)
            ++next;
        super.push_back(first);
        row_begin.push_back(static_cast<long>(rows.size()));
        value_begin.push_back(static_cast<long>(values.size()));
        rows.insert(rows.end(), Li.begin() + begin, Li.begin() + begin + count);
        for (long j = first; j < next; ++j) {
            values.insert(values.end(), size(j - first), 0.0);
            for (long k = Lp[size(j)]; k < Lp[size(j) + 1]; ++k) values.push_back(Lx[size(k)] * root[size(j)]);
        }
    }
    super.push_back(n);
    row_begin.push_back(static_cast<long>(rows.size()));
    return SupernodalFactor({.n = n,
                             .supernodes = static_cast<Index>(super.size()) - 1,
                             .super = super.data(),
                             .row_begin = row_begin.data(),
                             .value_begin = value_begin.data(),
                             .rows = rows.data(),
                             .values = values.data(),
                             .permutation = P.data()});
}

KluFactor::KluFactor(const SparseMatrix& A, bool symmetric) : n_(A.rows()) {
    const auto refuse = [&] {
        throw NumericalError("KLU: the " + std::to_string(A.rows()) + "x" + std::to_string(A.cols()) +
                             " sparse matrix is singular");
    };
    // Narrow bands have supernodes of a column each, and gain nothing.
    if (symmetric && BandFactor::half_width(A) > BandFactor::widest) {
        const Index blocks = identical_blocks(A), n = n_ / blocks;
        KluRefactorable klu(A.topLeftCorner(n, n), true);
        if (!klu.refactor()) refuse();
        if (auto factor = klu.as_cholesky()) {
            symmetric_ = factor_of_blocks(std::move(*factor), blocks);
            factor_cost_ = static_cast<double>(blocks) * klu.factor_cost();
            solve_cost_ = static_cast<double>(blocks) * klu.solve_cost();
            return;
        }
    }
    klu_ = std::make_unique<KluRefactorable>(A);
    if (!klu_->refactor()) refuse();
    factor_cost_ = klu_->factor_cost();
    solve_cost_ = klu_->solve_cost();
}

KluFactor::~KluFactor() = default;

void KluFactor::solve(Eigen::Ref<DenseMatrix> B) const {
    if (symmetric_)
        symmetric_->solve(B);
    else
        klu_->solve(B);
}

void KluFactor::compliance(const SparseMatrix& R, Index first, Eigen::Ref<DenseMatrix> S) const {
    if (symmetric_)
        symmetric_->compliance(R, first, S);
    else
        Factor::compliance(R, first, S);
}

void KluFactor::solve_transposed(Eigen::Ref<DenseMatrix> B) const {
    if (symmetric_)
        symmetric_->solve(B);
    else
        klu_->solve_transposed(B);
}

std::unique_ptr<const Factor> KluSolver::factorize(const Matrix& A) const {
    if (A.rows() != A.cols() || A.rows() == 0)
        throw InputError("KluSolver: A is " + A.shape() + ", expected square and not empty");
    return std::make_unique<KluFactor>(A.to_sparse());
}

}  // namespace tact
