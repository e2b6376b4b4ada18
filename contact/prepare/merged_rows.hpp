// Rows of B that say the same thing, made one.
#pragma once

#include <functional>
#include <memory>

#include "../../lib/contact_solver.hpp"

namespace tact {

/// What `prepare` makes of A and of B without those rows that equal an earlier one up to a positive factor (to rounding).
/// In each solve the tightest bound of such rows holds, and its row carries their multiplier, the others none. Where no rows
/// repeat, or B is not sparse, what it makes of A and B as they are.
std::unique_ptr<PreparedContact> prepare_merged(
    const Matrix& A, const Matrix& B,
    const std::function<std::unique_ptr<PreparedContact>(const Matrix& A, const Matrix& B)>& prepare);

}  // namespace tact
