// What the schemes make of impacts: the restitution they converge to, and what that does to reduced models.
#pragma once

#include "../../harness/machine.hpp"

namespace tact::bench {

/// [{"scene": "mass" or "bar", "integrator", "dt", "e_min", "e_max", "failed": marches that did}]: for the mass over 40 phases of the impact within its
/// step; for the bar, free at both ends, the mean velocity after over that before (exact: 1).
Json restitution_rows(bool small);

/// [{"integrator", "dt", "nearest_e", "distance_percent", "distances": [{"e", "percent"}]}]: eq. 17 between the membrane's
/// motion and the trapezoid's solutions with each e at a finer step.
Json membrane_rows(bool small);

/// {"gap_sensitivity": [{"integrator", "p", "change_percent"}], "reduced_error": [{"integrator", "p": [..], "percent": [..],
/// "geometric_mean_percent", "over_bdf2"}]}: the reduced plates of each integrator, trained by its own full run (POD of u,
/// NNMF of lambda), against that full run; and how far a gap changed by 1e-6 of itself moves the reduced motion.
Json reduced_plates(bool small);

}  // namespace tact::bench
