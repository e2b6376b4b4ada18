// The error of reduced runs at training parameters, for many choices of rows.
#pragma once

#include <vector>

#include "greedy.hpp"

namespace tact {

/// Of reduced runs with contact at single rows of B, over all samples the sum of  sum |U q - P u|^2 / sum |u|^2  over the
/// steps, P u being the best that U can do. Full runs are marched once for each U it meets, and kept as p numbers a step.
class TrainingError {
public:
    /// Holds the family. InputError without samples.
    TrainingError(const Shared<ContactFamily>& family, TrainingMethod method, TrainingContact contact,
                  std::vector<Parameter> samples);
    /// Infinite where a reduced run does not converge. NumericalError where a full one does not.
    double operator()(const DenseMatrix& U, const std::vector<Index>& rows);

private:
    struct Run {
        ContactProblem reduced;   // without rows
        AffineVector c;           // in all rows
        DenseMatrix best;         // Q'u with U = Q R, a column a step
        double squared_norm = 0;  // of u
    };
    void meet(const DenseMatrix& U);

    Shared<ContactFamily> family_;
    TrainingMethod method_;
    TrainingContact contact_;
    std::vector<Parameter> samples_;
    DenseMatrix U_, R_, B_U_;
    std::vector<Run> runs_;
};

}  // namespace tact
