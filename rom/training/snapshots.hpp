// What a full run leaves for training.
#pragma once

#include <vector>

#include "tact/lib/integrator.hpp"

namespace tact {

/// Multipliers below this fraction of their vector's largest, negative ones included, are rounding of the contact
/// solve: they count as zero.
inline constexpr double multiplier_rounding = 1e-12;

/// Dual snapshots of any number of runs, non-zero entries only; those without contact are not kept (section 4.4).
class DualSnapshots {
public:
    explicit DualSnapshots(Index constraints) : constraints_(constraints) {}
    void add(const ConstVectorRef& lambda);

    Index constraints() const { return constraints_; }
    /// The snapshots with contact.
    Index size() const { return static_cast<Index>(starts_.size()) - 1; }
    /// m x size(), >= 0.
    SparseMatrix matrix() const;

private:
    Index constraints_;
    std::vector<long> starts_{0};
    std::vector<long> rows_;
    std::vector<double> values_;
};

/// S and S_lambda as strides: step n is kept if it is a multiple; step 0 is, for both.
struct SnapshotStrides {
    long primal = 1;
    long dual = 1;
};

/// Records the snapshots of one run after the other. The primal ones are held until the next run begins; those that
/// are zero are not kept.
class SnapshotRecorder {
public:
    /// Storage is reserved for runs of this many steps. `dual` must outlive the recorder.
    SnapshotRecorder(Index unknowns, long steps, SnapshotStrides strides, DualSnapshots& dual);

    /// Starts the next run; the observer lives no longer than this recorder.
    Observer observer();
    auto primal() const { return primal_.leftCols(count_); }

private:
    SnapshotStrides strides_;
    DualSnapshots& dual_;
    DenseMatrix primal_;
    Index count_ = 0;
};

}  // namespace tact
