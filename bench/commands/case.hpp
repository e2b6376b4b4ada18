// One full run and the values a reference is compared with.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "../../lib/contact_solver.hpp"
#include "../harness/machine.hpp"
#include "command.hpp"

namespace tact::bench {

struct CaseOptions {
    std::string scene = {};                     ///< as study_scene names them
    Index n = 0;                                ///< nodes a side, or elements; 0: the usual number
    std::vector<double> gamma = {};             ///< as many as the scene has parameters
    std::optional<double> dt = {}, t_end = {};  ///< absent: the usual; static scenes take neither
    std::string integrator = {};                ///< empty: bdf2; without M and D the equilibria themselves
    std::vector<double> at = {};                ///< times on the grid, empty: the end; of a slow load too
    std::vector<std::array<double, 2>> points =
        {};  ///< (x, y) in the unit square, empty: its centre; (x, NaN) on the line
    std::shared_ptr<const ContactSolver> contact = {};  ///< null: AutomaticContact
};

/// Runs it: {"scene", "n", "unknowns", "contact_constraints", "gamma", "steps", "outcome", "first_contact_step",
/// "contact_intervals": how often contact began, "impulse": of the contact force, "most_active", "kkt": the worst of each
/// residual, "states": [{"t", "active", "energy" (where K is symmetric), "points", ...}]}. Where a contact solve does not
/// converge, "failed_step" and "message" say so and the states reached are there. For two plates a point has the
/// displacement of both, each from its own rest; on the line it has that of each body it lies in. Where the exact motion is
/// known a state has its "error": the largest of u at a node, the root mean square of v (whose waves are jumps), and that of
/// the contact force. InputError for a time that is not on the grid.
Json run_case(const CaseOptions& options);

/// "X1,Y1;X2,Y2", or "X1;X2" on the line (y is NaN). InputError for anything else.
std::vector<std::array<double, 2>> parse_points(const std::string& text);

Command case_command();

}  // namespace tact::bench
