// The dual active-set method of Goldfarb and Idnani on the condensed problem: finite, and safe with dependent rows.
#pragma once

#include "../../lib/errors.hpp"
#include "schur_factor.hpp"

namespace tact {

/// Solves  lambda >= 0,  w = S lambda - g >= 0,  lambda . w = 0  with S = B A^-1 B' (symmetric positive semidefinite,
/// m x m) and g = c - B A^-1 b: the contact conditions of  min 1/2 u'Au - u'b, Bu >= c.  One violated row at a time
/// enters at the exact step length of its multiplier; the dual objective rises at each step, so no active set comes
/// back. Rows that are dependent on the active ones move along the null direction instead of entering.
/// D. Goldfarb, A. Idnani, Math. Prog. 27 (1983) 1-33, in the form that keeps S(C, C) = L L'.
class GoldfarbIdnani {
public:
    struct [[nodiscard]] Report {
        Outcome outcome = Outcome::converged;  // inaccurate: a dependent row is violated by more than rounding
        int iterations = 0;
    };

    /// On the leading block of S as large as g. Warm start from the rows with lambda > 0 on entry; `lambda` and `w` hold the solution on a converged exit.
    /// Row i counts as violated where w_i < -allowance_i (in units of g_i); each row by its own size, so that one huge
    /// bound does not blind the others.
    Report solve(const DenseMatrix& S, const ConstVectorRef& g, const ConstVectorRef& allowance, VectorRef lambda,
                 VectorRef w);

    /// Room for m rows: solves of this size do not allocate.
    void reserve(Index m);
    /// The rows in contact, in the order they came.
    const SchurFactor& factor() const { return factor_; }
    /// After Outcome::infeasible: y >= 0 with S y = 0 and g'y > 0.
    const Vector& infeasibility() const { return certificate_; }
    /// Whether the last solve left a dependent row violated by what may be rounding.
    bool forgave() const { return !forgiven_.empty(); }
    /// S has changed under the factor: forget it.
    void reset() { factor_.clear(); }

private:
    void start_from(const DenseMatrix& S, const ConstVectorRef& g, const ConstVectorRef& lambda);
    static constexpr double forgivable = 1e4;  // allowances that a dependent row may stay violated by
    bool excludes(const ConstVectorRef& g, Index q);
    void gaps(const DenseMatrix& S, const ConstVectorRef& g, VectorRef w) const;
    SchurFactor factor_;
    std::vector<Index> forgiven_;  // dependent rows that rounding alone violates, in this solve
    Vector multiplier_, l_, r_, certificate_;
};

}  // namespace tact
