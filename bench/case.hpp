// One full run and the values a reference is compared with.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tact/bench/machine.hpp"
#include "tact/lib/contact_solver.hpp"

namespace tact::bench {

struct CaseOptions {
    std::string scene = {};                     ///< as study_scene names them
    Index n = 0;                                ///< nodes a side; 0: the paper's
    std::vector<double> gamma = {};             ///< as many as the scene has parameters
    std::optional<double> dt = {}, t_end = {};  ///< absent: the paper's; static scenes take neither
    std::string integrator = "bdf2";
    std::vector<double> at = {};                        ///< times on the grid; empty: the end
    std::vector<std::array<double, 2>> points = {};     ///< in the unit square; empty: its centre
    std::shared_ptr<const ContactSolver> contact = {};  ///< null: AutomaticContact
};

/// Runs it: {"scene", "n", "unknowns", "contact_constraints", "gamma", "steps", "outcome", "first_contact_step",
/// "most_active", "kkt": the worst of each residual, "states": [{"t", "active", "energy", "points", ...}]}. Where a contact
/// solve does not converge, "failed_step" and "message" say so and the states reached are there. For two plates a point has
/// the displacement of both, each from its own rest. InputError for a time that is not on the grid.
Json run_case(const CaseOptions& options);

/// "X1,Y1;X2,Y2". InputError for anything else.
std::vector<std::array<double, 2>> parse_points(const std::string& text);

}  // namespace tact::bench
