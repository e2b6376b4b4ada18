// Snapshots to factorise: the non-zero rows and columns of a non-negative matrix.
#pragma once

#include <vector>

#include "../../lib/types.hpp"

namespace tact {

/// X >= 0 without its zero rows and columns. Factors are kept as their transposes, k rows, so that a product touches
/// whole columns of them; it goes over the entries of X one by one, or is a dense one where X is filled enough.
class NonNegativeBlock {
public:
    /// InputError if X has a negative, NaN or infinite entry (named).
    explicit NonNegativeBlock(const SparseMatrix& X);

    Index rows() const { return sparse_.rows(); }
    Index cols() const { return sparse_.cols(); }
    double norm() const { return norm_; }
    /// Where its rows and columns lie in the matrix it was made of.
    const std::vector<Index>& row_places() const { return row_places_; }
    const std::vector<Index>& column_places() const { return column_places_; }

    /// H' X' = (X H)', k x rows.
    DenseMatrix times(const DenseMatrix& H_transposed) const;
    /// W' X = (X' W)', k x cols.
    DenseMatrix transposed_times(const DenseMatrix& W_transposed) const;
    DenseMatrix dense() const { return sparse_; }

private:
    SparseMatrix sparse_;
    DenseMatrix dense_;  // empty where X is sparse
    std::vector<Index> row_places_, column_places_;
    double norm_ = 0;
};

}  // namespace tact
