#include "tact/rom/training/pod.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <string>

#include "tact/lib/errors.hpp"
#include "tact/rom/orthonormal.hpp"
#include "tact/rom/training/gram.hpp"

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
    if (!W.is_symmetric())
        throw InputError("pod: inner_product is " + W.shape() + " and not symmetric, expected it to be");
    const GramEigen eigen = gram_eigen(X.transpose() * W.times(X));
    const Index r = resolved(eigen.singular_values, options, pod_snapshots_resolution);
    DenseMatrix modes = X * (eigen.vectors.leftCols(r) * eigen.singular_values.head(r).cwiseInverse().asDiagonal());
    modes = orthonormal_in(W, std::move(modes));
    fix_signs(modes);
    return {std::move(modes), eigen.singular_values.head(r)};
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
    if (!X.allFinite()) throw InputError("pod: X has a NaN or infinite entry, expected finite entries");
    if (options.inner_product) {
        const Matrix& W = *options.inner_product;
        if (W.rows() != X.rows() || W.cols() != X.rows())
            throw InputError("pod: inner_product is " + W.shape() + ", expected " + std::to_string(X.rows()) + "x" +
                             std::to_string(X.rows()));
        if (const Vector* w = W.diagonal_entries()) return in_diagonal_product(X, *w, options);
        return in_general_product(X, W, options);
    }
    if (X.size() == 0) return {DenseMatrix(X.rows(), 0), Vector(0)};
    Pod result = std::min(X.rows(), X.cols()) <= pod_svd_size ? by_svd(X, options) : by_snapshots(X, options);
    fix_signs(result.modes);
    return result;
}

}  // namespace tact
