// Smooth functions of few parameters as data.
#pragma once

#include <functional>
#include <vector>

#include "../../lib/problem/contact_family.hpp"

namespace tact {

/// N numbers as functions of d parameters: the sum over k of coefficients.col(k) T_k1(x_1) ... T_kd(x_d), with x the place of
/// gamma in the box, -1 to 1 in each parameter, and k = k1 + counts_1 (k2 + counts_2 (...)).
struct ChebyshevSeries {
    Parameter lower, upper;     ///< the box; a parameter with lower = upper is not read
    std::vector<Index> counts;  ///< of the polynomials in each parameter
    DenseMatrix coefficients;   ///< N x the product of the counts; 0 x 0: there is no series

    Index size() const { return coefficients.rows(); }
    bool empty() const { return coefficients.size() == 0; }
    /// Any gamma with d entries; outside the box polynomials leave the function soon.
    Vector at(const Parameter& gamma) const;
};

struct ChebyshevOptions {
    double tolerance = 1e-11;  ///< of the largest value: the last coefficients in each parameter come down to this
    Index max_count = 96;      ///< in one parameter
    Index max_points = 20000;  ///< of the tensor grid
};

struct ChebyshevFit {
    ChebyshevSeries series;  ///< empty where 4 points in each parameter are more than max_points
    double error = 0;       ///< largest difference at 64 points between the nodes, as a fraction of the largest value
    bool resolved = false;  ///< whether the tolerance was reached within the counts allowed
};

/// Fills `out`, N numbers.
using ParameterFunction = std::function<void(const Parameter& gamma, VectorRef out)>;

/// Interpolates at tensor Chebyshev points, in each parameter more of them until the coefficients have decayed, and leaves
/// out what has (Trefethen, Approximation Theory and Approximation Practice, 2013). InputError unless the box is finite
/// with lower <= upper.
ChebyshevFit fit_chebyshev(const ParameterFunction& function, Index size, const Parameter& lower,
                           const Parameter& upper, const ChebyshevOptions& options = {});

/// `count` points that fill the box evenly, the same each time, none on its faces (Roberts' additive recurrence with the
/// powers of the root of x^(d+1) = x + 1). One empty point where there are no parameters.
std::vector<Parameter> spread_points(const Parameter& lower, const Parameter& upper, Index count);

}  // namespace tact
