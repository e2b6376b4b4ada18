// How things fail: bad input throws InputError, a refusing library throws NumericalError, and an iteration that
// ended returns an Outcome inside a report. Nothing else.
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

namespace tact {

/// Wrong shapes, NaN, a negative dual basis, an unreadable file. Says object, field, found and expected.
struct InputError : std::invalid_argument {
    using std::invalid_argument::invalid_argument;
};

/// A singular factor or a library that refused: where, its code, its text.
struct NumericalError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// How an iteration ended. Everything but `converged` leaves the caller's state untouched.
enum class Outcome {
    converged,
    iteration_limit,      ///< the iteration budget was used up
    cycling,              ///< an active set came back and no fall-back was allowed
    infeasible,           ///< the constraints exclude each other
    unbounded,            ///< A is singular along a direction no constraint blocks
    inaccurate,           ///< ended, but the KKT residual is above the tolerance
    step_limit,           ///< an adaptive integrator used up its internal steps
    step_too_small,       ///< its error or stage tests kept failing down to the smallest step
    tolerance_too_small,  ///< it was asked for more accuracy than rounding leaves
    not_finite,           ///< a load, a gap or r(u) is NaN or infinite; the report says which
    stopped               ///< an observer or the user asked to stop
};

std::string_view to_string(Outcome outcome);

/// The fewest digits that read back as the same number, for messages: 1e-07, 0.1, -inf, nan.
std::string shown(double number);

}  // namespace tact
