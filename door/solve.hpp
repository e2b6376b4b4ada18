// The equilibrium of a static problem.
#pragma once

#include "../lib/time/stage.hpp"

namespace tact {

/// Solves K u + r(u) = f(0) + B' lambda, B u >= c(0), lambda >= 0, lambda . (B u - c) = 0. The contact solver is
/// AutomaticContact unless one is given. Whether it was solved, and how well, is in `report`. InputError as validate, and if
/// the problem has an M or a D.
StaticSolution solve(const ContactProblem& problem, const Shared<ContactSolver>& contact = {});

}  // namespace tact
