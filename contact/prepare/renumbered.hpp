// Unknowns and rows in an order in which a solve reads memory along, where the caller's is as good as random.
#pragma once

#include <functional>
#include <memory>

#include "../../lib/contact_solver.hpp"

namespace tact {

/// What `prepare` makes of A, B in a numbering by waves (lib/sparse/numbering.hpp), rows by their first unknown, behind
/// vectors that are put in order on the way in and out: five gathers a solve. Where the caller's numbering reads well, or A is
/// not sparse, what it makes of A and B as they are.
std::unique_ptr<PreparedContact> prepare_renumbered(
    const Matrix& A, const Matrix& B,
    const std::function<std::unique_ptr<PreparedContact>(const Matrix& A, const Matrix& B)>& prepare);

}  // namespace tact
