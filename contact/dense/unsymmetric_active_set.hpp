// The primal-dual active set on a condensed problem that is not symmetric.
#pragma once

#include <Eigen/LU>
#include <vector>

#include "active_set.hpp"
#include "exchanges.hpp"

namespace tact {

/// Solves  lambda >= 0,  w = S lambda - g >= 0,  lambda . w = 0  on the leading block of S, x'Sx > 0, by an LU factor of
/// S(C, C) for each set C. The factor of the last set is kept. Outcomes: `inaccurate` where rows in contact are dependent,
/// `cycling` where rounding keeps the sets from an end.
class UnsymmetricActiveSet {
public:
    /// As CondensedActiveSet::solve.
    CondensedActiveSet::Report solve(const DenseMatrix& S, const ConstVectorRef& g, const ConstVectorRef& allowance,
                                     VectorRef lambda, VectorRef w);
    void forget() { rows_.clear(); }

private:
    bool factor(const DenseMatrix& S);

    Exchanges exchanges_;
    std::vector<char> active_;
    std::vector<Index> rows_, wanted_, wrong_;  // rows_: of the factor, none if it is to be made anew
    Eigen::PartialPivLU<DenseMatrix> lu_;
    Vector right_;
};

}  // namespace tact
