#include "nnmf_updates.hpp"

#include <algorithm>

#include "non_negative_least_squares.hpp"

namespace tact {
namespace {

/// Columns of F do not meet, so each goes through all its updates in turn, along with its gradient S f - p; an entry
/// that stays zero costs nothing, and most do.
void hierarchical(DenseMatrix& F, const DenseMatrix& P, const DenseMatrix& S, int sweeps) {
    const Index rank = F.rows();
    DenseMatrix gradient = S * F - P;
    for (Index i = 0; i < F.cols(); ++i) {
        double* f = &F(0, i);
        auto g = gradient.col(i);
        for (int sweep = 0; sweep < sweeps; ++sweep)
            for (Index j = 0; j < rank; ++j) {
                if (!(S(j, j) > 0)) continue;  // the other factor's vector is zero: nothing to fit
                const double step = std::max(-g[j] / S(j, j), -f[j]);
                if (step == 0) continue;
                f[j] = std::max(f[j] + step, 0.0);
                g += step * S.col(j);
            }
    }
}

void multiplicative(DenseMatrix& F, const DenseMatrix& P, const DenseMatrix& S, int sweeps) {
    for (int sweep = 0; sweep < sweeps; ++sweep) {
        const DenseMatrix fitted = S * F;
        F = (fitted.array() > 0).select(F.cwiseProduct(P).cwiseQuotient(fitted), F);
    }
}

void least_squares(DenseMatrix& F, const DenseMatrix& P, const DenseMatrix& S) {
    for (Index i = 0; i < F.cols(); ++i) {
        // Where the limit is reached f is still no worse than it was, which is all a sweep needs.
        (void)non_negative_least_squares(S, P.col(i), F.col(i));
    }
}

}  // namespace

void update_factor(NnmfUpdates updates, DenseMatrix& F, const DenseMatrix& P, const DenseMatrix& S, int sweeps) {
    switch (updates) {
        case NnmfUpdates::hierarchical: return hierarchical(F, P, S, sweeps);
        case NnmfUpdates::multiplicative: return multiplicative(F, P, S, sweeps);
        case NnmfUpdates::least_squares: return least_squares(F, P, S);
    }
}

}  // namespace tact
