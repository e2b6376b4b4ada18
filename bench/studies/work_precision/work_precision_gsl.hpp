// GSL's odeiv2 on contact-free problems: what a general library makes of the same equations, and references.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "work_precision_scenes.hpp"

namespace tact::bench {

/// y' = F(t, y), with a constant Jacobian for the implicit methods (empty for the others).
struct OrdinaryProblem {
    std::function<void(double t, const double* y, double* derivative)> derivative;
    DenseMatrix jacobian;
    Vector y0;
};
/// M u'' = f - K u on y = (u, v), M diagonal. InputError for another M, a D, an r or contact rows.
OrdinaryProblem ordinary(const ContactProblem& problem, bool with_jacobian);

/// "msbdf", "msadams", "rk8pd", "rkf45".
struct OrdinaryRun {
    std::string failure;  ///< empty: done
    long steps = 0;
    DenseMatrix y;  ///< at the times, columns
};
/// rtol and atol per component; stops early, with a failure, after `limit` CPU s. Interrupted.
OrdinaryRun solve_ordinary(const std::string& method, const OrdinaryProblem& problem,
                           const std::vector<double>& times, double rtol, double atol, double limit);

}  // namespace tact::bench
