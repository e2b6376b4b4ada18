// Recorded states: what snapshots, errors and pictures are made of.
#pragma once

#include <vector>

#include "integrator.hpp"

namespace tact {

/// Which accepted steps to keep: every `stride`-th, and the initial state when `initial`.
struct Recording {
    long stride = 1;
    bool initial = true;
    bool multipliers = true;
};

/// The recorded columns u(t_j), lambda(t_j) of one march. Storage is reserved for the whole march at its start. A handle:
/// copies, and the observer, share what is recorded.
class Trajectory {
public:
    /// `steps`: of the march to be recorded.
    Trajectory(const ContactProblem& problem, long steps, Recording recording = {});

    /// An observer that records into this trajectory.
    Observer observer() const;

    Index size() const { return static_cast<Index>(record_->times.size()); }
    const std::vector<double>& times() const { return record_->times; }
    const std::vector<long>& steps() const { return record_->steps; }
    auto u() const { return record_->u.leftCols(size()); }
    auto lambda() const { return record_->lambda.leftCols(record_->recording.multipliers ? size() : 0); }

private:
    struct Record {
        Recording recording;
        DenseMatrix u = {}, lambda = {};
        std::vector<double> times = {};
        std::vector<long> steps = {};
    };
    std::shared_ptr<Record> record_;
};

}  // namespace tact
