// The steps that set up a smoothed-aggregation hierarchy: aggregates, prolongator, Galerkin product.
#pragma once

#include <algorithm>
#include <vector>

#include "../types.hpp"

namespace tact {

/// Sparse rows with 4-byte indices.
struct CompressedRows {
    int rows = 0;
    int columns = 0;
    std::vector<int> start, column;
    std::vector<double> value;

    int begin(int row) const { return start[static_cast<std::size_t>(row)]; }
    int end(int row) const { return start[static_cast<std::size_t>(row) + 1]; }
    int column_at(int entry) const { return column[static_cast<std::size_t>(entry)]; }
    double value_at(int entry) const { return value[static_cast<std::size_t>(entry)]; }
    int longest_row() const {
        int longest = 0;
        for (int i = 0; i < rows; ++i) longest = std::max(longest, end(i) - begin(i));
        return longest;
    }
};

/// The columns of A as rows: A' in rows, A itself if it is symmetric.
CompressedRows compressed_columns(const SparseMatrix& A);

/// The diagonal; entries that are not stored are zero.
std::vector<double> diagonal_of(const CompressedRows& A);

/// Colours so that no two coupled unknowns share one: greedy in the given numbering.
std::vector<int> greedy_colours(const CompressedRows& A);

/// Disjoint neighbourhoods of strongly coupled unknowns, |a_ij| > strength sqrt(a_ii a_jj).
struct Aggregates {
    std::vector<int> of;    ///< per unknown: its aggregate, -1 if it is coupled to nothing
    std::vector<int> root;  ///< per aggregate: the unknown it grew from
};
Aggregates aggregates_of(const CompressedRows& A, const std::vector<double>& diagonal, double strength);

/// P = (I - omega D^-1 A) P0 with P0 the indicator of the aggregates and omega = 1.8 / max_i sum_j |a_ij| / a_ii, over
/// a bound of the spectral radius of D^-1 A. (Vanek, Mandel, Brezina, Computing 56, 1996.)
CompressedRows smoothed_prolongator(const CompressedRows& A, const std::vector<double>& diagonal,
                                    const Aggregates& aggregates);

CompressedRows transposed(const CompressedRows& A);

/// P' A P, A symmetric.
CompressedRows galerkin_product(const CompressedRows& A, const CompressedRows& P, const CompressedRows& P_transposed);

}  // namespace tact
