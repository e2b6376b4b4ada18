// Residuals that do not cancel: sums of products in twice the working precision.
#pragma once

#include <cmath>
#include <utility>

#include "../problem/matrix.hpp"

namespace tact {

/// y = x + sum of products A x, as if in twice the working precision and rounded once at the end.
/// T. Ogita, S. Rump, S. Oishi, SIAM J. Sci. Comput. 26 (2005): Dot2.
class ExtendedSums {
public:
    void start(const ConstVectorRef& x) {
        high_ = x;
        low_.setZero(x.size());
    }
    /// y += sign A x, or A' x.
    void add(const Matrix& A, bool transposed, double sign, const ConstVectorRef& x) {
        const auto term = [&](Index i, Index j, double a) {
            if (transposed) std::swap(i, j);
            add(i, sign * a, x[j]);
        };
        if (const Vector* diagonal = A.diagonal_entries()) {
            for (Index i = 0; i < diagonal->size(); ++i) term(i, i, (*diagonal)[i]);
        } else if (const DenseMatrix* dense = A.dense()) {
            for (Index j = 0; j < dense->cols(); ++j)
                for (Index i = 0; i < dense->rows(); ++i) term(i, j, (*dense)(i, j));
        } else {
            const SparseMatrix& sparse = *A.sparse();
            for (Index j = 0; j < sparse.outerSize(); ++j)
                for (SparseMatrix::InnerIterator entry(sparse, j); entry; ++entry)
                    term(entry.row(), j, entry.value());
        }
    }
    /// y_i += a x.
    void add(Index i, double a, double x) {
        const double product = a * x, lost = std::fma(a, x, -product);
        const double before = high_[i], sum = before + product;
        if (!std::isfinite(sum)) {  // a row that is switched off
            high_[i] = sum;
            return;
        }
        const double taken = sum - before;
        high_[i] = sum;
        low_[i] += lost + ((before - (sum - taken)) + (product - taken));
    }
    void end(Vector& y) const { y = high_ + low_; }

private:
    Vector high_, low_;
};

/// x'y in twice the working precision.
inline double extended_dot(const ConstVectorRef& x, const ConstVectorRef& y) {
    ExtendedSums sum;
    sum.start(Vector::Zero(1));
    for (Index i = 0; i < x.size(); ++i) sum.add(0, x[i], y[i]);
    Vector total;
    sum.end(total);
    return total[0];
}

}  // namespace tact
