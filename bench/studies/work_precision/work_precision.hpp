// The work-precision study: error against run time for every integrator.
#pragma once

#include <string>
#include <vector>

#include "../../harness/study.hpp"

namespace tact::bench {

struct WorkPrecisionOptions {
    bool small =
        false;  ///< membrane 12 x 12 and plates 8 x 8 instead of the paper's 200 x 200 and 100 x 100, bars likewise
    int repeats = 5;
    std::vector<std::string> scenes = {};  ///< of precision_scene_names; empty: all
    bool answers = true;                   ///< the measurements behind the closing table that are no rows
};

/// Peers: GSL's odeiv2 where there is no contact, Siconos where it was found when this was built.
///
/// {"study", "size", "repeats", "limit_seconds" after which a march is given up, "machine", "peers", "scenes": [{"scene", "what", "unknowns", "constraints", "references": [{"how",
/// "own_error_u", "own_error_lambda", "methods"}]}], "rows": [...], "answers": [...]}.
///
/// A row: {"scene", "integrator", "parameter", "steps", "seconds", "error_u", "error_lambda", "energy_drift",
/// "restitution_min", "restitution_max", "outcome"}; on a run that fails the numbers are null and "outcome", "message" say why.
///   seconds        CPU time of a march on a fresh workspace, median; everything the march prepares is in it.
///   error_u        max_k |u(t_k) - ref|_M / max_k |ref(t_k)|_M over the output times
///   error_lambda   of J(t) = int_0^t sum_i lambda_i: (sum_k (J - ref)^2 / sum_k ref^2)^(1/2)
///   energy_drift   (energy at the end - work of load and damping - energy at first) / largest energy
/// The last three are of a second march, which is not timed. InputError for a bad option; Interrupted.
Json run_work_precision(const WorkPrecisionOptions& options);

/// The closing table and the curves in short, for the terminal; and the page.
std::string work_precision_table(const Json& json);
std::string work_precision_markdown(const Json& json);

const Study& work_precision_study();

}  // namespace tact::bench
