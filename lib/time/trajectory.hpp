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

/// The recorded columns u(t_j), lambda(t_j) of one march. Storage is reserved for the whole march at its start.
class Trajectory {
public:
    /// `steps`: of the march to be recorded.
    Trajectory(const ContactProblem& problem, long steps, Recording recording = {});

    /// An observer that records into this trajectory, which must outlive it.
    Observer observer();

    Index size() const { return static_cast<Index>(times_.size()); }
    const std::vector<double>& times() const { return times_; }
    const std::vector<long>& steps() const { return steps_; }
    auto u() const { return u_.leftCols(size()); }
    auto lambda() const { return lambda_.leftCols(recording_.multipliers ? size() : 0); }

private:
    Recording recording_;
    DenseMatrix u_, lambda_;
    std::vector<double> times_;
    std::vector<long> steps_;
};

}  // namespace tact
