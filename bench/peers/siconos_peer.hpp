// Siconos' own time stepping on scenes of the work-precision study, through a program of its own (tact-peer-siconos).
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "../studies/work_precision/work_precision_run.hpp"

namespace tact::bench {

/// What the rows call it.
inline constexpr const char* siconos_method = "Siconos moreau-jean";
/// Its options in words.
inline constexpr const char* siconos_options =
    "TimeStepping with SICONOS_TS_LINEAR, MoreauJeanOSI with theta = 1/2, one LagrangianLinearTIDS with sparse M and "
    "K, "
    "NewtonImpactNSL with e = 0 on each row, LCP by Lemke's method; one march, the making of its objects not timed";

/// The program lies beside this one where Siconos was found when it was built.
std::optional<std::string> siconos_program();

/// Rows like precision_row's, one for each of the scene's grids; those that by the grid before would take more than `limit`
/// CPU s are left out and say so. M, K, B, c and f go as they are; where f jumps Siconos sees the mean of both limits, so that
/// its theta-rule takes half of each. No energy_drift where there is a load: Siconos keeps no account of work. `done` is
/// called after each. InputError for a D, an r or a c that moves.
std::vector<Json> siconos_rows(const PrecisionScene& scene, const std::string& program, double limit,
                               const std::function<void()>& done);

}  // namespace tact::bench
