// The closing table of the work-precision study: what the integrators have to reach, and whether they do.
#pragma once

#include "../../../lib/problem/contact_problem.hpp"
#include "../../../lib/time/integrator.hpp"
#include "../../harness/machine.hpp"

namespace tact::bench {

/// [{"question", "target", "answer", "met", ...}], from the rows and from measurements of their own.
Json precision_answers(const Json& rows, bool small);

/// Bdf2's steps for a reduced problem written out: M = I, K diagonal, contact solves by the same prepared solver, nothing
/// recorded. Returns the last u. NumericalError if a contact solve fails.
Vector hand_written_bdf2(const ContactProblem& reduced, const TimeGrid& grid, ContactWorkspace& workspace);

}  // namespace tact::bench
