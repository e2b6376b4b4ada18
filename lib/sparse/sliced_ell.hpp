// A sparse matrix in slices of eight rows, for products and sweeps at vector speed.
#pragma once

#include <vector>

#include "tact/lib/types.hpp"

namespace tact {

/// Rows in slices of `lanes`. A slot of a slice holds one entry of each row; where its columns follow each other
/// (column of lane l = first + l: meshes numbered along lines, also colour by colour) only the first is kept and the
/// operand is read as one vector; else all are. Operands are padded by `padding` numbers on both sides, because a
/// slot may reach past the ends with zero weight.
class SlicedEll {
public:
    static constexpr Index lanes = 8;
    static constexpr Index padding = 8;

    SlicedEll() = default;
    /// Takes the rows of A in this order, with columns renumbered by `position` (of old index j: its new one);
    /// entries on the diagonal are left out if `without_diagonal`.
    SlicedEll(const SparseMatrix& rows_of_A_transposed, const std::vector<Index>& order,
              const std::vector<Index>& position, bool without_diagonal);

    Index rows() const { return rows_; }
    Index slices() const { return static_cast<Index>(slice_.size()) - 1; }

    /// sum[l] = (A x)_l for the rows of one slice; x points at number 0 of a padded operand.
    void multiply_slice(Index slice, const double* x, double* sum) const {
        double s[lanes] = {};
        for (auto k = slice_[static_cast<std::size_t>(slice)]; k < slice_[static_cast<std::size_t>(slice) + 1]; ++k) {
            const double* value = &value_[k * lanes];
            const long column = column_[k];
            if (column >= first_run) {
                const double* operand = x + column;
                for (int l = 0; l < lanes; ++l) s[l] += value[l] * operand[l];
            } else {
                const int* index = &index_[static_cast<std::size_t>(gathered - column) * lanes];
                for (int l = 0; l < lanes; ++l) s[l] += value[l] * x[index[l]];
            }
        }
        for (int l = 0; l < lanes; ++l) sum[l] = s[l];
    }

    /// y = A x, both padded.
    void multiply(const double* x, double* y) const;

private:
    static constexpr long first_run = -padding;
    static constexpr long gathered = first_run - 1;  // column_ = gathered - number of the index group
    Index rows_ = 0;
    std::vector<std::size_t> slice_;  // first slot of each slice
    std::vector<long> column_;        // per slot
    std::vector<double> value_;       // per slot and lane
    std::vector<int> index_;          // per gathered slot and lane
};

/// Colours of the graph of A so that no two coupled unknowns share one: greedy in the given numbering.
std::vector<int> greedy_colouring(const SparseMatrix& A);

}  // namespace tact
