// What the strategies ask of B: its rows, and whether they overlap.
#pragma once

#include <cmath>
#include <span>
#include <vector>

#include "../../lib/problem/matrix.hpp"

namespace tact {

/// The rows of B with their column indices and weights, ready to be gathered and scattered.
class ConstraintRows {
public:
    explicit ConstraintRows(const Matrix& B);

    Index rows() const { return static_cast<Index>(start_.size()) - 1; }
    std::span<const int> columns(Index row) const { return {&column_[at(row)], at(row + 1) - at(row)}; }
    std::span<const double> weights(Index row) const { return {&weight_[at(row)], at(row + 1) - at(row)}; }

    /// B_i u.
    double gather(Index row, const double* u) const {
        double sum = 0;
        for (auto k = at(row); k < at(row + 1); ++k) sum += weight_[k] * u[column_[k]];
        return sum;
    }
    /// |B_i||u|.
    double gather_absolute(Index row, const double* u) const {
        double sum = 0;
        for (auto k = at(row); k < at(row + 1); ++k) sum += std::abs(weight_[k] * u[column_[k]]);
        return sum;
    }
    /// u += s B_i'.
    void scatter(Index row, double s, double* u) const {
        for (auto k = at(row); k < at(row + 1); ++k) u[column_[k]] += s * weight_[k];
    }
    /// No unknown is in two rows, and no row is empty: bounds, node-to-node pairs.
    bool disjoint() const { return disjoint_; }
    /// Every row has exactly one entry.
    bool bounds() const;

private:
    std::size_t at(Index row) const { return start_[static_cast<std::size_t>(row)]; }
    std::vector<std::size_t> start_;
    std::vector<int> column_;
    std::vector<double> weight_;
    bool disjoint_ = true;
};

/// Rows of B times diag(unit), a column each.
SparseMatrix scaled_rows(const Matrix& B, const Vector& unit);

/// The unknowns that rows of B have entries on, rising; none if they are more than `most`.
std::vector<Index> unknowns_in_rows(const Matrix& B, Index most);

}  // namespace tact
