// Triangular solves with a sparse Cholesky factor, in storage of our own.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "tact/lib/types.hpp"

namespace tact {

/// P A P' = L L' as a library leaves it. Supernode s: columns super[s] .. super[s+1]-1 of L, dense on the rows
/// rows[row_begin[s]] .. rows[row_begin[s+1]-1], whose first are the columns themselves; values from
/// values[value_begin[s]] on, column by column. Row i of P A P' is row permutation[i] of A.
struct SupernodalCholesky {
    Index n = 0;
    Index supernodes = 0;
    const long* super = nullptr;
    const long* row_begin = nullptr;
    const long* value_begin = nullptr;
    const long* rows = nullptr;
    const double* values = nullptr;
    const long* permutation = nullptr;
};

/// A copy of the factor, made to be read by a few right-hand sides at memory speed: A = U S U' in the permuted order,
/// with S block diagonal (blocks of at most 8 columns, their inverses stored) and U block lower triangular with
/// identities on its diagonal. So neither pass has a triangular system to solve, only products: bands of 8 or 4 rows,
/// read in the order they are stored in and then backwards, leading zeros left out.
/// A block whose inverse would cost accuracy is split, down to single columns (L D L').
/// Belongs to one thread at a time.
class SupernodalFactor {
public:
    explicit SupernodalFactor(const SupernodalCholesky& L);

    Index size() const { return n_; }
    /// x := A^-1 x for each column x. Sixteen are solved together; where all of them are still zero the forward pass has
    /// nothing to do (columns of a unit matrix, forces at a few nodes).
    void solve(std::span<double* const> columns) const;

private:
    static constexpr int widest = 8;  ///< columns of a diagonal block, rows of a band
    static constexpr int height_for(Index rows) { return rows <= 4 ? 4 : 8; }

    /// Some rows of U next to each other: `height` (8 or 4) numbers for each of the columns first_column ..
    struct Band {
        std::int32_t first_column;  ///< counted within the supernode
        std::int32_t height;
    };
    struct DiagonalBlock {
        std::int32_t first;  ///< counted within the supernode
        std::int32_t width;
    };
    struct Supernode {
        std::int32_t first, width;
        std::int32_t blocks_begin, blocks_end;  ///< diagonal blocks; each has a band, of its own rows
        std::int32_t bands_begin, bands_end;    ///< bands of the rows below
        std::int32_t rows_begin;                ///< of the bands, in rows_
        std::int64_t values_begin, values_end;
    };
    struct alignas(64) Line {
        double entries[8];
    };
    class Builder;

    template <int columns> void solve_chunk(std::span<double* const> x) const;
    template <int columns> void forward(double* w) const;
    template <int columns> void backward(double* w, double* sums) const;

    Index n_;
    std::vector<Supernode> supernodes_;
    std::vector<DiagonalBlock> blocks_;
    std::vector<Band> block_bands_, bands_;
    std::vector<std::int32_t> rows_;    ///< of the bands; n stands for no row
    std::vector<std::int32_t> row_of_;  ///< of the permuted matrix, for each row of A
    std::vector<Line> values_, inverses_;
    std::int32_t widest_supernode_ = 0;
    mutable std::vector<Line> work_, sums_;
};

}  // namespace tact
