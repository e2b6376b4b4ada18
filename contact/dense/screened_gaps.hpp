// Which gaps are open for certain, told from few modes in single precision.
#pragma once

#include <span>
#include <vector>

#include "../../lib/types.hpp"

namespace tact {

/// Proves B u > c row by row for one dense B and many (u, c): from the first 32 columns in single precision, with the
/// Cauchy-Schwarz bound |B_tail||u_tail| on the others; for rows that leaves in doubt from 64 columns, from all of them
/// where such rows are many, and at last each in double precision. Tells most where the first columns lead, as in
/// modal coordinates. A proof covers the rounding of B u however it is summed.
class ScreenedGaps {
public:
    explicit ScreenedGaps(const DenseMatrix& B);
    /// The rows that are not proven open, ascending; valid until the next call. A c of -infinity is open, a NaN is not.
    std::span<const Index> in_doubt(const ConstVectorRef& u, const ConstVectorRef& c);

private:
    /// A strip of rows: column after column, `lanes` times a small number wide.
    struct Strip {
        Index first_row, vectors;
        const float* entries;
    };
    static constexpr Index lanes = 16, widest = 6;

    void take_columns(Index first, Index last);
    bool take_looks(const ConstVectorRef& u, const ConstVectorRef& c, double total, double second, double third,
                    double unit);
    Index mark_doubts(const Eigen::VectorXf& tail_size, double tail, Index columns, double size);

    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor | memory> B_;
    Vector row_size_, inverse_size_;
    Index near_, far_;         // the columns of the first and the second look
    Eigen::VectorXf entries_;  // of the rows B_i / |B_i|
    std::vector<Strip> strips_;
    Eigen::VectorXf near_tail_, far_tail_, no_tail_;  // of those rows, rounded up
    Eigen::VectorXf direction_, sum_, bound_;
    bool needs_all_ = false;  // the last answer did not come from fewer columns: the next one will not either
    Eigen::VectorXi marks_;   // of the rows in doubt, not zero
    std::vector<Index> doubt_;
};

}  // namespace tact
