// Every contact strategy once: its name, what it takes, and how it is prepared.
#pragma once

#include <memory>
#include <span>
#include <string_view>

#include "automatic.hpp"

namespace tact {

/// What B may be for a strategy.
enum class RowsTaken {
    any,
    disjoint,  ///< no unknown in two rows, no row empty
    bounds     ///< one entry a row
};

/// One strategy. Whoever runs over all of them (the chooser, the laws, the names of the front door) reads the table.
struct StrategyFacts {
    ContactStrategy strategy;
    std::string_view name;
    RowsTaken rows;
    bool unsymmetric;   ///< takes an A that is not symmetric
    bool semidefinite;  ///< takes a singular A
    /// Iterations of a solve, in the strategy's own count, that are some ten times the usual ones; 0: they say nothing.
    int patience;
    std::unique_ptr<PreparedContact> (*prepare)(const Matrix& A, const Matrix& B);
};

/// Stiffness of the softest direction of A, scaled to unit diagonal, below which soft directions are solved for apart: with nine
/// digits gone in a factor a residual at rounding says little about forces.
inline constexpr double nearly_singular = 1e-9;

std::span<const StrategyFacts> strategy_table();
const StrategyFacts& facts_of(ContactStrategy strategy);

}  // namespace tact
