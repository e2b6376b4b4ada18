// Why a combination of M, D and K has no solver.
#pragma once

#include <string>

#include "stage.hpp"

namespace tact {

/// Which of K, M, D is indefinite where mass M + damping D + stiffness K is, with the entry or the direction that shows it, and
/// how large `mass` has to be at least where a positive definite M could outweigh K: that asks for a smaller dt. Empty where
/// the combination is not found to be indefinite. Costs a factorisation of each: for messages.
std::string why_indefinite(const ContactProblem& problem, const Combination& combination);

}  // namespace tact
