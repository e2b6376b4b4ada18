// R' A^-1 R for an R with few entries, from the part of a factor that they reach.
#pragma once

#include "supernodal_factor.hpp"

namespace tact {

/// A is block diagonal, `blocks` times the matrix that the factor is of. The parts of a column of R in the blocks are
/// right-hand sides of one factor; those that repeat one before up to sign (forces between equal bodies) are solved once.
/// Both passes keep to the paths from the rows of R to the root of the elimination tree. The factor must outlive it.
class Compliance {
public:
    Compliance(const SupernodalFactor& factor, Index blocks) : factor_(factor), blocks_(blocks), few_(factor) {}

    /// S(i, j) := r_i' A^-1 r_j for i <= j, j from `first` on; R has blocks * factor.size() rows.
    void form(const SparseMatrix& R, Index first, Eigen::Ref<DenseMatrix> S);

private:
    struct Entry {
        std::int32_t block, row;
        double value;
    };
    /// A part of a column, and how often (0, 1, -1) each block repeats it.
    struct RightHandSide {
        Index column;
        std::vector<Entry> entries;
        std::vector<double> repeats;
    };
    void take_rows(const SparseMatrix& R);
    void take_right_hand_sides(Index first);
    std::span<const Entry> row(Index i) const {
        return {entries_.data() + start_[static_cast<std::size_t>(i)],
                entries_.data() + start_[static_cast<std::size_t>(i) + 1]};
    }
    void solve(std::span<const RightHandSide> some, const SupernodalFactor::Reach& reach, Eigen::Ref<DenseMatrix> S);

    const SupernodalFactor& factor_;
    Index blocks_;
    SupernodalFactor::FewRows few_;
    std::vector<Entry> entries_;  // of the columns of R, one after the other
    std::vector<std::size_t> start_;
    std::vector<RightHandSide> right_hand_sides_;
};

}  // namespace tact
