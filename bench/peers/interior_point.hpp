// The paper's kind of full solver, for comparison: an interior-point method on each step's quadratic programme.
#pragma once

#include <memory>
#include <string>

#include "../../lib/contact_solver.hpp"

namespace tact::bench {

/// IPOPT as a contact solver, or null where the harness was built without it. Tolerance 1e-8 on a load scaled to one,
/// exact constant Hessian and Jacobian. Rows of B with one positive entry become bounds on the unknowns, which is what IPOPT
/// solves fastest; other rows become linear inequalities.
std::shared_ptr<const ContactSolver> interior_point();
std::string interior_point_version();

}  // namespace tact::bench
