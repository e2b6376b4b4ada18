#include "pod.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <utility>

#include "../../lib/errors.hpp"
#include "../model/orthonormal.hpp"
#include "gram.hpp"

namespace tact {
namespace {

constexpr double svd_resolution = 1e-14;

/// How many of the descending singular values to keep.
Index resolved(const Vector& sigma, const PodOptions& options, double resolution) {
    if (sigma.size() == 0 || !(sigma[0] > 0)) return 0;
    const double smallest = std::max(options.tolerance, resolution) * sigma[0];
    const Index wanted = options.rank > 0 ? std::min(options.rank, sigma.size()) : sigma.size();
    Index count = 0;
    while (count < wanted && sigma[count] > smallest) ++count;
    return count;
}

Pod by_svd(const DenseMatrix& X, const PodOptions& options) {
    const auto truncate = [&](const auto& svd) {
        const Vector& sigma = svd.singularValues();
        const Index r = resolved(sigma, options, svd_resolution);
        return Pod{svd.matrixU().leftCols(r), sigma.head(r)};
    };
    if (X.rows() <= 2 * X.cols()) return truncate(Eigen::BDCSVD<DenseMatrix>(X, Eigen::ComputeThinU));
    // Tall: the triangle of a QR factorisation has the same singular values and right singular vectors.
    const Eigen::HouseholderQR<DenseMatrix> qr(X);
    const DenseMatrix R = qr.matrixQR().topRows(X.cols()).triangularView<Eigen::Upper>();
    Pod small = truncate(Eigen::BDCSVD<DenseMatrix>(R, Eigen::ComputeThinU));
    DenseMatrix modes = DenseMatrix::Zero(X.rows(), small.modes.cols());
    modes.topRows(X.cols()) = small.modes;
    modes.applyOnTheLeft(qr.householderQ());
    return {std::move(modes), std::move(small.singular_values)};
}

Pod by_snapshots(const DenseMatrix& X, const PodOptions& options) {
    const bool wide = X.cols() > X.rows();
    const GramEigen eigen = gram_eigen(wide ? gram(X.transpose()) : gram(X));
    const Index r = resolved(eigen.singular_values, options, pod_snapshots_resolution);
    DenseMatrix modes = wide ? DenseMatrix(eigen.vectors.leftCols(r)) : DenseMatrix(X * eigen.vectors.leftCols(r));
    return {orthonormal_columns(std::move(modes), 0), eigen.singular_values.head(r)};
}

/// X~ = L'X with W = L L' turns the W inner product into the Euclidean one; modes = L^-T modes~.
Pod in_diagonal_product(const DenseMatrix& X, const Vector& w, PodOptions options) {
    if (!(w.array() > 0).all()) throw InputError("pod: inner_product is not positive definite, expected it to be");
    const Vector root = w.cwiseSqrt();
    options.inner_product.reset();
    Pod pod_ = pod(root.asDiagonal() * X, options);
    pod_.modes.array().colwise() /= root.array();
    fix_signs(pod_.modes);
    return pod_;
}

Pod in_general_product(const DenseMatrix& X, const Matrix& W, const PodOptions& options) {
    const GramEigen eigen = gram_eigen(X.transpose() * W.times(X));
    const Index r = resolved(eigen.singular_values, options, pod_snapshots_resolution);
    DenseMatrix modes = X * (eigen.vectors.leftCols(r) * eigen.singular_values.head(r).cwiseInverse().asDiagonal());
    return {orthonormal_in(W, std::move(modes)), eigen.singular_values.head(r)};
}

Pod by_all_of(const DenseMatrix& X, const PodOptions& options) {
    if (options.inner_product) return in_general_product(X, *options.inner_product, options);
    return std::min(X.rows(), X.cols()) <= pod_svd_size ? by_svd(X, options) : by_snapshots(X, options);
}

/// Independent, normally distributed: Box and Muller's, because std::normal_distribution differs between libraries.
DenseMatrix gaussian(Index rows, Index cols, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    const auto uniform = [&] { return (static_cast<double>(random() >> 11) + 0.5) * 0x1p-53; };
    return DenseMatrix::NullaryExpr(rows, cols, [&] {
        const double radius = std::sqrt(-2 * std::log(uniform()));
        return radius * std::cos(2 * std::numbers::pi * uniform());
    });
}

/// Q, orthonormal in the inner product, whose span nearly holds the leading modes, and its coefficients Q'W X.
struct Range {
    DenseMatrix Q, coefficients;
};

Range sketched_range(const DenseMatrix& X, Index width, const PodOptions& options) {
    const std::optional<Matrix>& W = options.inner_product;
    const auto range = [&](const DenseMatrix& Y) {
        DenseMatrix Q = orthonormal_columns(X * Y);
        return W ? orthonormal_in(*W, std::move(Q)) : Q;
    };
    const auto coefficients = [&](const DenseMatrix& Q) -> DenseMatrix {
        return (W ? W->times(Q) : Q).transpose() * X;
    };
    DenseMatrix Q = range(gaussian(X.cols(), width, options.sketch->seed));
    for (int k = 0; k < options.sketch->power_iterations; ++k)
        Q = range(orthonormal_columns(coefficients(Q).transpose()));
    DenseMatrix C = coefficients(Q);
    return {std::move(Q), std::move(C)};
}

Pod by_sketch(const DenseMatrix& X, const PodOptions& options) {
    constexpr Index first_guess = 32;  // modes, where the tolerance decides
    const Index spare = options.sketch->oversampling;
    Index width = (options.rank > 0 ? options.rank : first_guess) + spare;
    for (; width < std::min(X.rows(), X.cols()); width *= 2) {
        const Range range = sketched_range(X, width, options);
        const Index found = range.Q.cols();
        if (found == 0) return {range.Q, Vector(0)};
        const Eigen::HouseholderQR<DenseMatrix> qr(range.coefficients.transpose());
        const DenseMatrix R = qr.matrixQR().topRows(found).triangularView<Eigen::Upper>();
        const Eigen::BDCSVD<DenseMatrix> svd(R.transpose(), Eigen::ComputeThinU);
        const Vector& sigma = svd.singularValues();
        const Index r = resolved(sigma, options, dependent_column);
        // Else smaller ones above the tolerance may be beyond the sketch; a narrower range is that of all of X.
        if (r + spare <= width || found < width) return {range.Q * svd.matrixU().leftCols(r), sigma.head(r)};
    }
    return by_all_of(X, options);
}

}  // namespace

DenseMatrix orthonormal_in(const Matrix& W, DenseMatrix X) {
    for (int pass = 0; pass < 2 && X.cols() > 0; ++pass) {
        const Eigen::LLT<DenseMatrix> llt(X.transpose() * W.times(X));
        if (llt.info() != Eigen::Success)
            throw InputError("pod: inner_product is not positive definite on the snapshots, expected it to be");
        llt.matrixU().solveInPlace<Eigen::OnTheRight>(X);
    }
    return X;
}

Pod pod(const DenseMatrix& X, const PodOptions& options) {
    if (options.rank < 0 || options.rank > X.cols())
        throw InputError("pod: rank is " + std::to_string(options.rank) +
                         ", expected at most the number of snapshots, " + std::to_string(X.cols()));
    if (options.sketch && (options.sketch->oversampling < 0 || options.sketch->power_iterations < 0))
        throw InputError("pod: sketch has oversampling " + std::to_string(options.sketch->oversampling) + " and " +
                         std::to_string(options.sketch->power_iterations) +
                         " power_iterations, expected at least 0 of each");
    if (!X.allFinite()) throw InputError("pod: X has a NaN or infinite entry, expected finite entries");
    if (options.inner_product) {
        const Matrix& W = *options.inner_product;
        if (W.rows() != X.rows() || W.cols() != X.rows())
            throw InputError("pod: inner_product is " + W.shape() + ", expected " + std::to_string(X.rows()) + "x" +
                             std::to_string(X.rows()));
        if (const Vector* w = W.diagonal_entries()) return in_diagonal_product(X, *w, options);
        if (!W.is_symmetric())
            throw InputError("pod: inner_product is " + W.shape() + " and not symmetric, expected it to be");
    }
    if (X.size() == 0) return {DenseMatrix(X.rows(), 0), Vector(0)};
    Pod result = options.sketch ? by_sketch(X, options) : by_all_of(X, options);
    fix_signs(result.modes);
    return result;
}

}  // namespace tact
