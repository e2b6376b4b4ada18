// Quadratic programmes from files, solved and compared with known answers: how a user checks us on his own problems.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "../../lib/contact_solver.hpp"
#include "../harness/machine.hpp"
#include "command.hpp"

namespace tact::bench {

/// Solves  min 1/2 u'Au - u'b,  Bu >= c  of every folder in `folder` (itself included) that holds A.mtx or B.mtx:
///   A.mtx, B.mtx   Matrix Market, coordinate real, A symmetric       b.txt, c.txt   one number a line, c may hold -inf
///   expected.json  optional: "outcome" or "outcome_allowed"; "objective" with "tolerance", relative to |u'Au|/2 + |u'b|;
///                  "u", a list or the name of a file there, with "tolerance_u", relative to max|u|; null: not compared.
///                  Where u = 0 is expected, relative to the larger of max|b| / max|A| and max|c| / max|B|.
/// Returns a list by name of {"name", "outcome", "objective", "u", "lambda", "kkt": {"stationarity", "penetration",
/// "negativity", "complementarity"}, "infeasibility", "ray", "certificate", "seconds", "agrees", ...}; what has no value is null, `agrees` without expected.json too.
///
/// infeasibility: y >= 0 with B'y = 0, c'y > 0; ray: d with A d = 0, B d >= 0, b'd > 0; certificate: what these come to, B'y
/// and A d by the size of their terms. The message of an infeasible problem names an empty row of B that is its cause.
///
/// outcome: as to_string(Outcome), or "unsupported": A is not symmetric or not positive semidefinite; "invalid input": a
/// file is missing or malformed; "failed": the solver threw something else. "message" says why for these and where an answer
/// does not agree. A problem that fails does not end the run. seconds: CPU time of prepare and solve.
/// InputError if there is no such folder; Interrupted.
Json run_qp(const std::filesystem::path& folder, const ContactSolver& solver);

/// Whether nothing disagrees and nothing was invalid input or failed.
bool qp_agrees(const Json& problems);

/// Its table for the terminal, and a line a message.
std::string qp_table(const Json& problems);

Command qp_command();

}  // namespace tact::bench
