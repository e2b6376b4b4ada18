#include "relative_error.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace tact {
namespace {

std::string shape(Index rows, Index cols) { return std::to_string(rows) + "x" + std::to_string(cols); }

/// |c| over the finite rows of one time.
double largest_finite(const Vector& c) {
    return c.size() == 0 ? 0 : (c.array() > -infinity).select(c.array().abs(), 0).maxCoeff();
}

/// [B U q - c]_- over its scale.
double penetration(const ContactProblem& full, const ReducedBasis& basis, const Eigen::Ref<const DenseMatrix>& q,
                   const std::vector<double>& times) {
    if (full.constraints() == 0) return 0;
    constexpr Index block_columns = 32;
    const DenseMatrix B_U = full.B.times(basis.U);
    Vector c = full.c.at(0);
    double deepest = 0, scale = 0, reach = 0;
    DenseMatrix image;
    for (Index from = 0; from < q.cols(); from += block_columns) {
        image.noalias() = B_U * q.middleCols(from, std::min(block_columns, q.cols() - from));
        for (Index j = 0; j < image.cols(); ++j) {
            if (!full.c.constant()) c = full.c.at(times[static_cast<std::size_t>(from + j)]);
            deepest = std::max(deepest, (c - image.col(j)).maxCoeff());
            scale = std::max(scale, largest_finite(c));
            reach = std::max(reach, image.col(j).cwiseAbs().maxCoeff());
        }
    }
    if (scale == 0) scale = reach;
    return deepest > 0 ? deepest / scale : 0;
}

}  // namespace

RelativeError relative_error(const ContactProblem& full, const Eigen::Ref<const DenseMatrix>& u,
                             const ReducedBasis& basis, const Eigen::Ref<const DenseMatrix>& q,
                             const std::vector<double>& times) {
    const Index n = full.size(), p = basis.primal_size(), count = static_cast<Index>(times.size());
    if (u.rows() != n || u.cols() != count)
        throw InputError("relative_error: u is " + shape(u.rows(), u.cols()) + ", expected " + shape(n, count));
    if (q.rows() != p || q.cols() != count)
        throw InputError("relative_error: q is " + shape(q.rows(), q.cols()) + ", expected " + shape(p, count));
    constexpr Index block_rows = 256;
    double error = 0, norm = 0;
    DenseMatrix lifted(block_rows, count);
    for (Index i = 0; i < n; i += block_rows) {
        const Index rows = std::min(block_rows, n - i);
        auto block = lifted.topRows(rows);
        block.noalias() = basis.U.middleRows(i, rows) * q;
        error += (block - u.middleRows(i, rows)).squaredNorm();
        norm += u.middleRows(i, rows).squaredNorm();
    }
    const double ratio = error == 0 ? 0 : error / norm;
    return {100 * ratio, 100 * std::sqrt(ratio), penetration(full, basis, q, times)};
}

RelativeError relative_error(const ContactProblem& full, const Trajectory& u, const ReducedBasis& basis,
                             const Trajectory& q) {
    if (u.size() != q.size())
        throw InputError("relative_error: the reduced march has " + std::to_string(q.size()) +
                         " recorded states, expected the full one's " + std::to_string(u.size()));
    for (std::size_t j = 0; j < u.times().size(); ++j)
        if (std::abs(u.times()[j] - q.times()[j]) > 1e-9 * std::abs(u.times().back()))
            throw InputError("relative_error: reduced state " + std::to_string(j) +
                             " is at t = " + shown(q.times()[j]) + ", expected " + shown(u.times()[j]));
    return relative_error(full, u.u(), basis, q.u(), u.times());
}

RelativeError relative_error(const ContactProblem& full, const StaticSolution& u, const ReducedBasis& basis,
                             const StaticSolution& q) {
    return relative_error(full, u.u, basis, q.u, std::vector<double>{0});
}

}  // namespace tact
