// Functions of time as data.
#pragma once

#include "../../lib/time/integrator.hpp"

namespace tact {

/// k functions of time by their limits at the points of a grid. On the grid (to 1e-6 of a step) they are exact, between its
/// points linear: fixed-step methods that ask at t_n see no difference, stages within a step an error of order dt^2.
struct TimeTable {
    TimeGrid grid;
    DenseMatrix left, right;  ///< k x (steps + 1)
    std::vector<double> jumps;

    bool empty() const { return left.size() == 0; }
    /// Before the grid and after it: the value at its end.
    void evaluate(double t, Side side, VectorRef out) const;
};

/// The coefficients of `functions`; empty where they are constant. `refinement`: table points to a step of the grid.
/// InputError if a jump within the grid is not on one of them.
TimeTable tabulate(const AffineVector& functions, const TimeGrid& grid, long refinement = 1);

}  // namespace tact
