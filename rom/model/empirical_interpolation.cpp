#include "empirical_interpolation.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <string>

#include "../../lib/errors.hpp"

namespace tact {

EmpiricalInterpolation interpolate_empirically(const DenseMatrix& samples, double tolerance, Index max_terms) {
    if (!samples.allFinite())
        throw InputError(
            "interpolate_empirically: the samples have a NaN or infinite entry, expected finite entries");
    EmpiricalInterpolation result;
    DenseMatrix rest = samples, columns(samples.rows(), 0);
    const double scale = samples.size() > 0 ? samples.cwiseAbs().maxCoeff() : 0;
    while (scale > 0) {
        Index point = 0, sample = 0;
        const double worst = rest.cwiseAbs().maxCoeff(&point, &sample);
        result.error = worst / scale;
        // An entry that is a point already comes back as rounding only: there is nothing more to learn.
        const bool known = std::find(result.points.begin(), result.points.end(), point) != result.points.end();
        if (result.error <= tolerance || result.size() >= std::min(max_terms, samples.cols()) || known) break;
        result.points.push_back(point);
        columns.conservativeResize(Eigen::NoChange, result.size());
        columns.rightCols(1) = rest.col(sample) / rest(point, sample);
        const Eigen::RowVectorXd row = rest.row(point);
        rest.noalias() -= columns.rightCols(1) * row;
        rest.row(point).setZero();
    }
    // columns(points, :) is lower triangular with a unit diagonal.
    result.modes = columns;
    if (result.size() > 0) {
        const DenseMatrix at_points = columns(result.points, Eigen::all);
        at_points.triangularView<Eigen::UnitLower>().solveInPlace<Eigen::OnTheRight>(result.modes);
        for (Index k = 0; k < result.size(); ++k)
            result.modes.row(result.points[static_cast<std::size_t>(k)]) = Eigen::RowVectorXd::Unit(result.size(), k);
    }
    return result;
}

}  // namespace tact
