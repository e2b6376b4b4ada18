// Sparse rows for products that also want the size of their terms, block by block.
#pragma once

#include <vector>

#include "../problem/matrix.hpp"

namespace tact {

/// The rows of a sparse matrix in blocks of `block_rows`, for A x and |A||x| taken together. Neighbouring rows whose
/// entries stand at the same distances from the diagonal (any mesh numbered along its lines) make a run, stored by
/// diagonals so that its products vectorise; a run of equal rows keeps one of them, and reads its operand only.
class RowRuns {
public:
    /// Not a power of two: sums and sizes side by side would share the last twelve bits of their addresses, and each load
    /// would wait for the other's store.
    static constexpr Index block_rows = 384;

    RowRuns() = default;
    /// Takes the columns of the argument as rows: pass A' for A.
    explicit RowRuns(const SparseMatrix& transposed);

    /// sum += sign A x and size += |A||x| for the rows of one block, both counted from the block's first row.
    void add(Index block, double sign, const double* x, double* sum, double* size) const;
    /// sum += factor A x, all rows.
    void add_product(double factor, const double* x, double* sum) const;

private:
    enum class Kind { single_rows, diagonals, equal_rows };
    struct Run {
        Kind kind;
        Index first, count;   ///< rows
        std::size_t entries;  ///< of a row
        std::size_t start;    ///< in distance_, or in single_start_
        std::size_t value;    ///< in value_
    };
    void add_run(const SparseMatrix& transposed, Index first, Index count);
    void add_single_rows(const SparseMatrix& transposed, Index first, Index count);
    template <bool with_size>
    void add_block(Index block, double factor, const double* x, double* sum, double* size) const;

    std::vector<Run> runs_;
    std::vector<std::size_t> first_run_{0};  // of each block
    std::vector<Index> distance_;            // column - row
    std::vector<double> value_;
    std::vector<std::size_t> single_start_;
    std::vector<int> single_column_;
    std::vector<double> single_value_;
};

/// y += factor A x for an A that is multiplied in every step: a sparse one is kept once more, as runs of rows.
class RepeatedProduct {
public:
    explicit RepeatedProduct(const Matrix& A);
    void add(double factor, const ConstVectorRef& x, VectorRef y) const;

private:
    Matrix A_;
    RowRuns runs_;
};

}  // namespace tact
