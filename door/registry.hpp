// The registry of all that tact brings.
#pragma once

#include "../lib/time/registry.hpp"

namespace tact {

/// Every integrator and contact solver by name. A copy takes a user's own as well.
///
/// Integrators, options in brackets: bdf2, bdf2-without-jump [e], central-difference [e], moreau-jean [theta, e],
/// quasi-static, trapezoid [rho, e], ida-fixed, ida [rtol, atol, order, e, first_step, max_step, most_steps, newton], and
/// sdirk2, tr-bdf2, esdirk32, sdirk54 [e], with fixed steps; with any of [rtol, atol, first_step, max_step, most_steps,
/// newton] adaptive. atol is rtol / 1000 unless given.
///
/// Contact solvers: automatic, diagonal, dense [compliance, screening], orthogonal, schur, klu-active-set, projected-cg,
/// colour-sor, multigrid, interior-point (finished by schur), principal-pivoting, floating, refined (around automatic).
const Registry& registry();

}  // namespace tact
