// What a full run leaves for training.
#pragma once

#include <functional>
#include <vector>

#include "../../lib/time/integrator.hpp"

namespace tact {

/// Multipliers below this fraction of their vector's largest, negative ones included, are rounding of the contact
/// solve: they count as zero.
inline constexpr double multiplier_rounding = 1e-12;

/// Dual snapshots of any number of runs, non-zero entries only (16 bytes each); those without contact are not kept
/// (section 4.4).
class DualSnapshots {
public:
    explicit DualSnapshots(Index constraints) : constraints_(constraints) {}
    void add(const ConstVectorRef& lambda);

    Index constraints() const { return constraints_; }
    /// The snapshots with contact.
    Index size() const { return static_cast<Index>(starts_.size()) - 1; }
    /// m x size(), >= 0.
    SparseMatrix matrix() const;

    template <class Archive> void serialize(Archive& archive) { archive(constraints_, starts_, rows_, values_); }

private:
    Index constraints_;
    std::vector<long> starts_{0};
    std::vector<long> rows_;
    std::vector<double> values_;
};

/// S and S_lambda: which states of a run become snapshots.
struct SnapshotSelection {
    long primal = 1;  ///< u of step n is kept if n is a multiple; that of step 0 is
    long dual = 1;    ///< lambda alike
    /// What differs from the one kept last in this run by no more than this fraction of its own norm is left out.
    double tolerance = 0;
};

/// Records the snapshots of one run after the other. Primal ones are handed on in blocks, so that no more than a block
/// is ever held; those that are zero are not kept.
class SnapshotRecorder {
public:
    using Sink = std::function<void(const Eigen::Ref<const DenseMatrix>& block)>;
    static constexpr Index block = 400;

    /// Blocks are n x at most `block` + 1, of equal widths for runs of this many steps. `dual` must outlive the recorder.
    SnapshotRecorder(Index unknowns, long steps, SnapshotSelection selection, DualSnapshots& dual, Sink sink);

    /// Starts the next run; the observer lives no longer than this recorder.
    Observer observer();
    /// Ends the run: hands on what is still held.
    void flush();

private:
    bool is_new(const ConstVectorRef& x, Vector& kept) const;

    SnapshotSelection selection_;
    DualSnapshots& dual_;
    Sink sink_;
    DenseMatrix primal_;
    Index count_ = 0;
    Vector last_primal_, last_dual_;  // kept last, where there is a tolerance
};

}  // namespace tact
