// A thin QR factor whose columns come and go.
#pragma once

#include "../../lib/types.hpp"

namespace tact {

/// D = Q R with orthonormal Q (n x k) and upper triangular R (k x k). Appending and removing a column cost O(n k).
class OrthogonalFactor {
public:
    explicit OrthogonalFactor(Index n) : n_(n), Q_(n, 0) {}
    Index size() const { return k_; }
    void clear() { k_ = 0; }
    auto Q() const { return Q_.leftCols(k_); }

    /// d = Q h + z with z orthogonal to Q, by one projection or two; returns |z|.
    double split(const ConstVectorRef& d, VectorRef h, VectorRef z) const;
    /// Appends the column that was split, which must not depend on the others (norm = |z| > 0).
    void append(const ConstVectorRef& h, const ConstVectorRef& z, double norm);
    void remove(Index column);
    /// x := R^-1 x and x := R^-T x.
    void solve(VectorRef x) const { R_.topLeftCorner(k_, k_).triangularView<Eigen::Upper>().solveInPlace(x); }
    void solve_transposed(VectorRef x) const {
        R_.topLeftCorner(k_, k_).triangularView<Eigen::Upper>().transpose().solveInPlace(x);
    }

private:
    Index n_;
    Index k_ = 0;
    DenseMatrix Q_, R_;
    mutable Vector correction_;
};

}  // namespace tact
