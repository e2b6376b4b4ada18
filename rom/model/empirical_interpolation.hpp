// A vector that depends on parameters, from few of its entries.
#pragma once

#include <vector>

#include "../../lib/types.hpp"

namespace tact {

/// x ~ modes * x(points), exact at the points: modes(points, :) is the identity.
struct EmpiricalInterpolation {
    std::vector<Index> points;  ///< k entries of x, in the order they were chosen
    DenseMatrix modes;          ///< N x k
    double error = 0;           ///< largest over all samples and entries, as a fraction of the largest entry

    Index size() const { return static_cast<Index>(points.size()); }
};

/// Chooses in turn the sample and the entry where the interpolation is worst, until that is at most `tolerance` times the
/// largest entry of the samples, or there are max_terms. N x S samples, a column each. InputError if an entry is not
/// finite. (Barrault, Maday, Nguyen, Patera, C. R. Acad. Sci. Paris 339, 2004; the worst entry of the worst sample.)
EmpiricalInterpolation interpolate_empirically(const DenseMatrix& samples, double tolerance, Index max_terms);

}  // namespace tact
