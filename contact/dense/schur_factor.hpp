// The Cholesky factor of the active block of B A^-1 B', kept while rows come and go.
#pragma once

#include <span>
#include <vector>

#include "../../lib/types.hpp"

namespace tact {

/// L L' = S(C, C) for an ordered set C of rows of a symmetric positive semidefinite S. Appending and removing a row
/// cost O(k^2). A row whose pivot falls below `dependence` times its diagonal is dependent on C and not taken.
class SchurFactor {
public:
    static constexpr double dependence = 1e-11;

    Index size() const { return static_cast<Index>(rows_.size()); }
    const std::vector<Index>& rows() const { return rows_; }
    void clear() { rows_.clear(); }

    /// L^-1 S(C, q) into `l`, and the pivot S_qq - l'l that appending q would have. l must hold size() numbers.
    double pivot(const DenseMatrix& S, Index q, VectorRef l) const;
    /// Takes q, whose `l` and positive `pivot` were just computed.
    void append(Index q, const ConstVectorRef& l, double pivot);
    /// Computes the pivot and takes q unless it is dependent; says whether it did.
    bool append(const DenseMatrix& S, Index q);
    /// Drops the row at this place of the order.
    void remove(Index place);
    /// Factors S(C, C) anew for the given rows (blocked when large); dependent ones are left out.
    void rebuild(const DenseMatrix& S, std::span<const Index> rows);
    /// The same from the factor at hand, of the same S: rows that leave are rotated out, new ones appended together.
    /// Anew where that would cost more, or a new row is dependent; says whether the factor at hand was kept.
    bool change(const DenseMatrix& S, std::span<const Index> rows);

    /// x := S(C, C)^-1 x.
    void solve(VectorRef x) const;
    /// x := L^-1 x.
    void solve_lower(VectorRef x) const;
    /// x := L^-T x.
    void solve_upper(VectorRef x) const;

    /// Room for k rows: up to there nothing allocates.
    void reserve(Index k);

private:
    bool append_all(const DenseMatrix& S, std::span<const Index> fresh);

    std::vector<Index> rows_, fresh_;
    std::vector<char> wanted_;
    DenseMatrix L_;  // the lower triangle of the leading size() x size() block
    Vector work_;
};

}  // namespace tact
