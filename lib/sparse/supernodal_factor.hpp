// Triangular solves with a sparse Cholesky factor, in storage of our own.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "../types.hpp"

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

    /// Supernodes by number, rising: the paths from some rows of A to the roots of the elimination tree.
    using Reach = std::vector<std::int32_t>;
    Reach reach(std::span<const std::int32_t> rows) const;
    /// Right-hand sides that are solved on a reach together.
    static constexpr int lanes = 16;
    /// As many columns on the rows of one reach; zero before the right-hand sides are put in.
    class FewRows;
    /// x := A^-1 x on the rows of `reach`, where x is zero elsewhere: neither pass has anything to do off the paths. The
    /// solution off them is not formed. (J. R. Gilbert, T. Peierls, SIAM J. Sci. Stat. Comput. 9 (1988) 862-874)
    void solve(const Reach& reach, FewRows& few) const;
    void clear(const Reach& reach, FewRows& few) const;

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
        std::int32_t rows_begin, rows_end;      ///< of the bands, in rows_
        std::int32_t inverses_end;
        std::int32_t parent;  ///< in the elimination tree; -1 for none
        std::int64_t values_begin, values_end;
    };
    struct alignas(64) Line {
        double entries[8];
    };
    class Builder;
    /// The lines as one run of numbers.
    static const double* begin_of(const std::vector<Line>& lines) { return lines.front().entries; }

    template <int columns> void solve_chunk(std::span<double* const> x) const;
    template <int columns> void forward(const Supernode& node, double* w) const;
    template <int columns> void backward(const Supernode& node, double* w, double* sums) const;
    template <int columns> double* sums() const;
    std::int32_t place(std::int32_t row) const { return row_of_[static_cast<std::size_t>(row)]; }

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

class SupernodalFactor::FewRows {
public:
    explicit FewRows(const SupernodalFactor& factor)
        : factor_(factor), lines_(static_cast<std::size_t>((factor.n_ + widest) * lanes / 8)) {}
    /// Of row `row` of A: `lanes` numbers.
    double* operator[](std::int32_t row) { return begin() + Index{factor_.place(row)} * lanes; }
    const double* operator[](std::int32_t row) const { return begin_of(lines_) + Index{factor_.place(row)} * lanes; }
    /// Where the row stands in the factor: near ones share most of their paths.
    std::int32_t place(std::int32_t row) const { return factor_.place(row); }

private:
    friend class SupernodalFactor;
    double* begin() { return lines_.front().entries; }
    const SupernodalFactor& factor_;
    std::vector<Line> lines_;
};

}  // namespace tact
