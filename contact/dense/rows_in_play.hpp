// The dual active set on the few rows that may close, whatever the number of the others.
#pragma once

#include <span>
#include <vector>

#include "condensed_rows.hpp"
#include "goldfarb_idnani.hpp"

namespace tact {

/// A set C of rows that only grows until it is cleared, and Goldfarb-Idnani on S(C, C), warm from solve to solve.
/// Allocates only in its constructor where S is there; without it, when C is larger than ever.
class RowsInPlay {
public:
    /// `condensed` must outlive this object.
    explicit RowsInPlay(const CondensedRows& condensed);

    std::span<const Index> rows() const { return rows_; }
    Index size() const { return static_cast<Index>(rows_.size()); }
    bool holds(Index row) const { return place_[static_cast<std::size_t>(row)] >= 0; }
    void clear();
    void add(Index row);

    /// Of the row in this place, to be set before a solve: g, its allowance, and the multiplier guessed.
    double& violation(Index place) { return g_[place]; }
    double& allowance(Index place) { return allowance_[place]; }
    double& multiplier(Index place) { return lambda_[place]; }
    /// As GoldfarbIdnani::solve; the multipliers are the solution on a converged exit.
    GoldfarbIdnani::Report solve();
    /// As GoldfarbIdnani::forgave.
    bool forgave() const { return dual_.forgave(); }

private:
    void make_room(Index rows);

    const CondensedRows& condensed_;
    DenseMatrix block_;  // S(C, C) leads
    std::vector<Index> rows_, place_;
    Vector g_, allowance_, lambda_, w_;
    GoldfarbIdnani dual_;
};

}  // namespace tact
