// What a dense contact solve has prepared of one (A, B): the condensed problem, its rows scaled to unit energy.
#pragma once

#include <vector>

#include "../../lib/types.hpp"

namespace tact {

struct CondensedRows {
    /// A row of B with one entry.
    struct Bound {
        Index row, column;
        double weight;
    };
    DenseMatrix B, W;           // of the scaled rows: W = A^-1 B'
    DenseMatrix S;              // B W, with compliance B W + E; empty where rows are so many that it is not formed
    Vector scale;               // B is that of the problem with row i times scale_i
    Vector compliance;          // the diagonal of E, for the rows of the problem; empty without
    std::vector<Bound> bounds;  // none with compliance: no row is then met exactly

    /// S(i, j), formed or not.
    double compliance_between(Index i, Index j) const {
        if (S.size() > 0) return S(i, j);
        const double soft = i == j && compliance.size() > 0 ? compliance[i] * scale[i] * scale[i] : 0;
        return B.row(i).dot(W.col(j)) + soft;
    }

    /// A violation counts above this fraction of the row's own |c_i| + |B_i u|, two digits above rounding.
    static constexpr double gap_tolerance = 2e-14;
};

}  // namespace tact
