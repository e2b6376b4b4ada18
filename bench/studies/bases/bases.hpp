// The study of bases: error against online time for every dual basis.
#pragma once

#include <string>
#include <vector>

#include "../../harness/study.hpp"

namespace tact::bench {

struct BasesOptions {
    bool small = false;  ///< as paper_study, fewer sizes
    int repeats = 5;
    std::vector<std::string> scenes = {};       ///< of the paper's three; empty: all
    std::vector<std::string> recipes = {};      ///< labels wanted; empty: those of the diagram
    std::vector<std::string> integrators = {};  ///< of marches: bdf2, trapezoid, bdf2-without-jump; empty: all
};

/// {"study", "size", "repeats", "machine", "trainings": [{"scene", "integrator", "samples", "snapshots", "contact_snapshots",
/// "seconds_full"}], "rows": [...]}. A row is one recipe at one size, its members neighbouring p or other seeds:
///   "scene", "integrator", "dual_basis", "p", "p_lambda", "supremizer_share", "compliance", "members",
///   "error_percent"      the worst over parameters outside the training set of eq. 16 or 17 as printed, geometric mean
///                        over the members; "error_min", "error_max" of them; "error_median" over the parameters;
///   "penetration"        largest of [B U q - c]_- in units of the gap scale, over all;
///   "us_per_step"        CPU time online, the gap's evaluation included in statics; median;
///   "training_seconds"   CPU time of both bases and the projection, full runs left out;
///   "kkt_residual"       worst of all steps; "pareto": no other row of the scene and integrator is better in both;
///   "outcome"            of a run that failed: numbers are then null.
/// InputError for a bad option; Interrupted.
Json run_bases(const BasesOptions& options);

std::string bases_table(const Json& json);
std::string bases_markdown(const Json& json);

const Study& bases_study();

}  // namespace tact::bench
