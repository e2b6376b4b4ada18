// Whether all gaps are open, told from few modes.
#pragma once

#include <array>

#include "tact/lib/types.hpp"

namespace tact {

/// Proves B u > c row by row for one dense B and many (u, c): from the 16 columns that move the rows most, with the
/// Cauchy-Schwarz bound |B_tail||u_tail| on the others; for rows that leaves in doubt from 64 columns, then from all. Which
/// columns lead is learnt from the u it has seen. A proof covers the rounding of B u however it is summed.
class ScreenedGaps {
public:
    static constexpr Index leading = 16;

    explicit ScreenedGaps(const DenseMatrix& B);
    /// Whether it pays: there are columns to leave out and rows to leave them out of.
    static bool pays(Index rows, Index columns) { return rows >= 8 && columns >= 2 * leading; }
    /// True only if every gap is open; false says nothing. A c of -infinity is open, a NaN is not.
    bool all_open(const ConstVectorRef& u, const ConstVectorRef& c);

private:
    static constexpr Index more = 64;  // columns of the second look

    void sort_columns();
    bool open_at_second_look(const ConstVectorRef& u, const ConstVectorRef& c, double total, double allowance);

    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    RowMajor B_;
    Vector column_size_, row_size_;
    Vector squares_;  // of each u_j, summed over calls
    long calls_ = 0, next_sort_ = 1;
    Eigen::VectorXi order_;
    DenseMatrix head_;  // m x leading
    RowMajor middle_;   // the first `more` columns
    Vector tail_size_, far_tail_size_;
    Vector lower_, slack_;
};

}  // namespace tact
