// Which strategy A and B call for, and which follow it.
#pragma once

#include <string_view>
#include <vector>

#include "automatic.hpp"

namespace tact {

struct StrategyChoice {
    ContactStrategy strategy;
    std::string_view reason;  ///< static lifetime
    /// Of SchurContact: rows in contact from which on another strategy is cheaper; 0: none.
    Index pool_rows = 0;
};

bool allowed(const AutomaticOptions& options, ContactStrategy strategy);

/// By the list in automatic.hpp. InputError if the options leave none.
StrategyChoice first_choice(const Matrix& A, const Matrix& B, const AutomaticOptions& options);

/// Those that follow the chosen one where it ends without a solution, sturdier ones later.
std::vector<ContactStrategy> followers(const StrategyChoice& first, const Matrix& A, const Matrix& B,
                                       const AutomaticOptions& options);

}  // namespace tact
