#include "klu_solver.hpp"

#include <klu.h>

#include <string>

#include "../errors.hpp"

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

KluRefactorable::KluRefactorable(SparseMatrix A) : A_(std::move(A)), klu_(std::make_unique<Library>()) {
    A_.makeCompressed();
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

KluFactor::KluFactor(const SparseMatrix& A) : klu_(A) {
    if (!klu_.refactor())
        throw NumericalError("KLU: the " + std::to_string(A.rows()) + "x" + std::to_string(A.cols()) +
                             " sparse matrix is singular");
}

std::unique_ptr<const Factor> KluSolver::factorize(const Matrix& A) const {
    if (A.rows() != A.cols() || A.rows() == 0)
        throw InputError("KluSolver: A is " + A.shape() + ", expected square and not empty");
    return std::make_unique<KluFactor>(A.to_sparse());
}

}  // namespace tact
