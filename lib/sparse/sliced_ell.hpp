// A sparse matrix in slices of eight rows, for products and sweeps at vector speed.
#pragma once

#include <cstring>
#include <vector>

#include "tact/lib/types.hpp"

namespace tact {

/// Rows in slices of `lanes`. A slot of a slice holds one entry of each row; where its columns follow each other
/// (column of lane l = first + l: meshes numbered along lines, also colour by colour) only the first is kept and the
/// operand is read as one vector; else all are. Operands are padded by `padding` numbers on both sides, because a
/// slot may reach past the ends with zero weight. Slices with the same values share them: where a mesh and its material
/// repeat, a sweep reads its operand and little else.
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

    /// One number a lane, in a vector register where there is one: GCC's and Clang's vector extension.
    typedef double Lanes
        __attribute__((vector_size(sizeof(double) * lanes)));  // NOLINT: `using` takes no attribute here
    static Lanes load(const double* x) {
        Lanes v;
        std::memcpy(&v, x, sizeof(v));
        return v;
    }
    static void store(double* x, const Lanes& v) { std::memcpy(x, &v, sizeof(v)); }

    /// (A x)_l for the rows of one slice; x points at number 0 of a padded operand.
    void multiply_slice(Index slice, const double* x, Lanes& sum) const {
        Lanes s = {};
        const std::size_t first = slice_[static_cast<std::size_t>(slice)];
        const std::size_t count = slice_[static_cast<std::size_t>(slice) + 1] - first;
        const double* value = value_.data() + values_of_[static_cast<std::size_t>(slice)];
        const int* slot = column_.data() + first;
        for (std::size_t k = 0; k < count; ++k, value += lanes) {
            const int column = slot[k];
            if (column >= first_run) {
                s += load(value) * load(x + column);
            } else {
                const int* index = &index_[static_cast<std::size_t>(gathered - column) * lanes];
                const Lanes operand = {x[index[0]], x[index[1]], x[index[2]], x[index[3]],
                                       x[index[4]], x[index[5]], x[index[6]], x[index[7]]};
                s += load(value) * operand;
            }
        }
        sum = s;
    }

    /// y = A x, both padded.
    void multiply(const double* x, double* y) const;

private:
    static constexpr int first_run = -static_cast<int>(padding);
    static constexpr int gathered = first_run - 1;  // column_ = gathered - number of the index group
    Index rows_ = 0;
    std::vector<std::size_t> slice_;      // first slot of each slice
    std::vector<int> column_;             // per slot
    std::vector<std::size_t> values_of_;  // per slice: where its values begin
    std::vector<double> value_;           // per slot and lane, of the different slices
    std::vector<int> index_;              // per gathered slot and lane
};

/// Colours of the graph of A so that no two coupled unknowns share one: greedy in the given numbering.
std::vector<int> greedy_colouring(const SparseMatrix& A);

}  // namespace tact
