// Whether all gaps are open, told from few modes.
#pragma once

#include "tact/lib/types.hpp"

namespace tact {

/// Proves B u > c row by row for one dense B and many (u, c): from the 16 columns that move the rows most, with the
/// Cauchy-Schwarz bound |B_tail||u_tail| on the others, then, for rows that leaves in doubt, from all columns. Which columns lead
/// is learnt from the u it has seen. A proof covers the rounding of B u however it is summed.
class ScreenedGaps {
public:
    static constexpr Index leading = 16;

    explicit ScreenedGaps(const DenseMatrix& B);
    /// Whether it pays: there are columns to leave out and rows to leave them out of.
    static bool pays(Index rows, Index columns) { return rows >= 8 && columns >= 2 * leading; }
    /// True only if every gap is open; false says nothing. A c of -infinity is open, a NaN is not.
    bool all_open(const ConstVectorRef& u, const ConstVectorRef& c);

private:
    void sort_columns();

    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    DenseMatrix B_;
    Vector column_size_, row_size_;
    Vector squares_;  // of each u_j, summed over the calls
    long calls_ = 0, next_sort_ = 1;
    Eigen::VectorXi order_;
    DenseMatrix head_;  // m x leading
    RowMajor tail_;
    Vector tail_size_, sorted_, lower_;
};

}  // namespace tact
