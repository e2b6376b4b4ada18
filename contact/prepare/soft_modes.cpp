#include "soft_modes.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

#include "../../lib/algebra/extended_sums.hpp"
#include "../../lib/errors.hpp"
#include "../../lib/sparse/cholmod_solver.hpp"
#include "pinned_unknowns.hpp"

namespace tact {
namespace {

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

/// Stiffness, of 1, below which an unknown is set apart: what is left has a condition that costs half the digits at most.
constexpr double soft_pivot = 1e-6;
/// The same for a direction of many unknowns. A slender body has many such and needs none of them set apart.
constexpr double soft_direction = 1e-9;
/// Added to the diagonal where there is no factor without: well above the rounding of one.
constexpr double shift_for_factor = 1e-11;
constexpr Index most_modes = 2000;
constexpr Index few_unknowns = 500, few_dense_unknowns = 1500;

/// In unknowns of unit stiffness. One without stiffness is measured by the largest weight a row has on it.
Matrix scaled_to_unit_diagonal(const Matrix& A, const Matrix& B, Vector& unit) {
    const Vector diagonal = A.main_diagonal();
    unit.resize(diagonal.size());
    Vector weight;
    for (Index j = 0; j < unit.size(); ++j) {
        if (diagonal[j] < 0)
            throw NumericalError("A is " + A.shape() + " and indefinite: entry " + std::to_string(j) +
                                 " of its diagonal is negative");
        if (diagonal[j] > 0) {
            unit[j] = 1 / std::sqrt(diagonal[j]);
            continue;
        }
        if (weight.size() == 0) {
            weight.setZero(unit.size());
            const SparseMatrix rows = B.to_sparse();
            for (Index k = 0; k < rows.outerSize(); ++k)
                for (SparseMatrix::InnerIterator it(rows, k); it; ++it)
                    weight[it.col()] = std::max(weight[it.col()], std::abs(it.value()));
        }
        unit[j] = weight[j] > 0 ? 1 / weight[j] : 1;
    }
    if (A.diagonal_entries()) return Matrix::diagonal(diagonal.unaryExpr([](double a) { return a > 0 ? 1.0 : 0.0; }));
    if (const DenseMatrix* dense = A.dense()) {
        DenseMatrix scaled = unit.asDiagonal() * (*dense) * unit.asDiagonal();
        return Matrix(DenseMatrix(0.5 * (scaled + scaled.transpose())));
    }
    SparseMatrix scaled = *A.sparse();
    for (Index j = 0; j < scaled.outerSize(); ++j)
        for (SparseMatrix::InnerIterator it(scaled, j); it; ++it) it.valueRef() *= unit[it.row()] * unit[j];
    return Matrix(std::move(scaled));
}

/// A(rows, rows) + shift I.
Matrix block_of(const Matrix& A, const std::vector<Index>& rows, const std::vector<Index>& place, double shift) {
    const auto n = static_cast<Index>(rows.size());
    if (const Vector* diagonal = A.diagonal_entries()) {
        Vector d(n);
        for (Index i = 0; i < n; ++i) d[i] = (*diagonal)[rows[at(i)]] + shift;
        return Matrix::diagonal(std::move(d));
    }
    if (const DenseMatrix* dense = A.dense()) {
        DenseMatrix block = (*dense)(rows, rows);
        block.diagonal().array() += shift;
        return Matrix(std::move(block));
    }
    const SparseMatrix& sparse = *A.sparse();
    SparseMatrix block(n, n);
    block.reserve(sparse.nonZeros());
    for (Index j = 0; j < n; ++j) {
        block.startVec(j);
        for (SparseMatrix::InnerIterator it(sparse, rows[at(j)]); it; ++it) {
            const Index i = place[at(it.row())];
            if (i >= 0) block.insertBack(i, j) = it.value() + (i == j ? shift : 0.0);
        }
    }
    block.finalize();
    return Matrix(std::move(block));
}

DenseMatrix orthonormal(const DenseMatrix& X) {
    const Eigen::HouseholderQR<DenseMatrix> qr(X);
    return qr.householderQ() * DenseMatrix::Identity(X.rows(), X.cols());
}

DenseMatrix absolute_times(const Matrix& A, const DenseMatrix& X) {
    if (const Vector* d = A.diagonal_entries()) return d->cwiseAbs().asDiagonal() * X;
    if (const DenseMatrix* dense = A.dense()) return dense->cwiseAbs() * X;
    return A.sparse()->cwiseAbs() * X;
}

}  // namespace

SoftModes::SoftModes(const Matrix& A, const Matrix& B, const std::vector<Index>& last)
    : A_(scaled_to_unit_diagonal(A, B, unit_)) {
    find_pinned(last);
    keep_soft_ones();
    refine();
    sort_by_stiffness();
}
SoftModes::SoftModes(SoftModes&&) noexcept = default;
SoftModes::~SoftModes() = default;

void SoftModes::find_pinned(const std::vector<Index>& last) {
    const Index n = A_.rows();
    if (A_.diagonal_entries() || n <= few_unknowns || (A_.dense() && n <= few_dense_unknowns)) {
        pinned_ = A_.diagonal_entries() ? without_stiffness(A_) : softest_pivots(A_.to_dense(), soft_pivot);
        factor(last, 0);
        return;
    }
    pinned_ = unknowns_far_apart(A_);
    for (int round = 0; round < 8; ++round) {
        bool shifted = false;
        try {
            factor(last, 0);
        } catch (const NumericalError&) {
            shifted = true;
            factor(last, shift_for_factor);
        }
        if (others_.empty()) return;
        // Pivots that need no shift may still hide a direction that is soft.
        const DenseMatrix modes = softest(shifted ? soft_pivot : soft_direction, soft_direction);
        if (modes.cols() == 0 && !shifted) return;
        if (modes.cols() == 0) break;
        pin(modes);
    }
    throw NumericalError("A is " + A_.shape() + " and indefinite or singular in a way that no few unknowns hold");
}

void SoftModes::factor(const std::vector<Index>& last, double shift) {
    if (static_cast<Index>(pinned_.size()) > most_modes)
        throw NumericalError("A is " + A_.shape() + " and has " + std::to_string(pinned_.size()) +
                             " directions without stiffness or more, expected at most " + std::to_string(most_modes));
    std::sort(pinned_.begin(), pinned_.end());
    place_.assign(at(A_.rows()), 0);
    for (const Index i : pinned_) place_[at(i)] = -1;
    others_.clear();
    for (Index i = 0; i < A_.rows(); ++i)
        if (place_[at(i)] == 0) {
            place_[at(i)] = static_cast<Index>(others_.size());
            others_.push_back(i);
        }
    factor_.reset();
    if (others_.empty()) return;
    const Matrix block = block_of(A_, others_, place_, shift);
    if (!A_.sparse()) {
        factor_ = DenseLinearSolver().factorize(block);
        return;
    }
    std::vector<Index> at_end;
    for (const Index i : last)
        if (place_[at(i)] >= 0) at_end.push_back(place_[at(i)]);
    factor_ = CholmodSolver(std::move(at_end)).factorize(block);
}

void SoftModes::solve(Eigen::Ref<DenseMatrix> x) const {
    DenseMatrix change;
    if (held_.cols() > 0) change = held_ * held_stiffness_.llt().solve(held_.transpose() * x);
    if (factor_) {
        DenseMatrix part = x(others_, Eigen::all);
        factor_->solve(part);
        x(others_, Eigen::all) = part;
    }
    for (const Index i : pinned_) x.row(i).setZero();
    if (held_.cols() > 0) x += change;
}

void SoftModes::compliance(const SparseMatrix& Q, Index first, DenseMatrix& S) const {
    if (factor_) {
        SparseMatrix part(factor_->size(), Q.cols());
        part.reserve(Q.nonZeros());
        for (Index j = 0; j < Q.cols(); ++j) {
            part.startVec(j);
            bool none = true;
            for (SparseMatrix::InnerIterator it(Q, j); it; ++it)
                if (place_[at(it.row())] >= 0) {
                    part.insertBack(place_[at(it.row())], j) = it.value();
                    none = false;
                }
            // A column on pinned unknowns only: an entry of value zero stands for it.
            if (none) part.insertBack(0, j) = 0;
        }
        part.finalize();
        factor_->compliance(part, first, S);
    } else {
        for (Index j = first; j < Q.cols(); ++j) S.col(j).head(j + 1).setZero();
    }
    if (held_.cols() == 0) return;
    const DenseMatrix G = Q.transpose() * held_;
    const DenseMatrix X = held_stiffness_.llt().solve(G.transpose());
    for (Index j = first; j < Q.cols(); ++j) S.col(j).head(j + 1) += G.topRows(j + 1) * X.col(j);
}

DenseMatrix SoftModes::softest(double soft, double none) {
    const auto n = static_cast<Index>(others_.size());
    const Matrix block = block_of(A_, others_, place_, 0);
    // A generator whose numbers are the same everywhere; distributions are not.
    std::mt19937_64 random(1);
    for (Index width = 8;; width *= 2) {
        width = std::min(width, n);
        DenseMatrix X(n, width);
        for (double& x : X.reshaped()) x = static_cast<double>(static_cast<std::int64_t>(random())) * 0x1p-63;
        for (int iteration = 0; iteration < 3; ++iteration) {
            X = orthonormal(X);
            factor_->solve(X);
        }
        X = orthonormal(X);
        const DenseMatrix energy = X.transpose() * block.times(X);
        const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> ritz(0.5 * (energy + energy.transpose()));
        const auto& values = ritz.eigenvalues();
        if (values[width - 1] <= none && width < n) {
            if (width >= most_modes)
                throw NumericalError("A is " + A_.shape() + " and has " + std::to_string(width) +
                                     " soft directions or more, expected at most " + std::to_string(most_modes));
            continue;
        }
        const Index count = (values.array() <= soft).count();
        DenseMatrix modes = DenseMatrix::Zero(A_.rows(), count);
        modes(others_, Eigen::all) = X * ritz.eigenvectors().leftCols(count);
        return modes;
    }
}

/// Sets apart one more unknown a mode: those that hold them best.
void SoftModes::pin(const DenseMatrix& modes) {
    const Eigen::ColPivHouseholderQR<DenseMatrix> qr(modes.transpose());
    for (Index k = 0; k < modes.cols(); ++k) pinned_.push_back(qr.colsPermutation().indices()[k]);
}

/// Of the pinned unknowns those that A itself holds go back: into P, by the part of R that belongs to them.
void SoftModes::keep_soft_ones() {
    const auto k = static_cast<Index>(pinned_.size());
    R_.setZero(A_.rows(), k);
    for (Index j = 0; j < k; ++j) R_(pinned_[at(j)], j) = 1;
    if (k == 0) return;
    DenseMatrix correction = A_.times(R_);
    solve(correction);
    R_ -= correction;
    const DenseMatrix C = R_.transpose() * A_.times(R_);
    const std::vector<Index> soft = softest_pivots(0.5 * (C + C.transpose()), soft_pivot);
    if (static_cast<Index>(soft.size()) == k) return;
    std::vector<Index> stiff, left;
    for (Index j = 0; j < k; ++j)
        if (!std::binary_search(soft.begin(), soft.end(), j)) stiff.push_back(j);
    held_ = R_(Eigen::all, stiff);
    held_stiffness_ = C(stiff, stiff);
    const DenseMatrix coupling = C(stiff, soft);
    R_ = DenseMatrix(R_(Eigen::all, soft)) - held_ * held_stiffness_.llt().solve(coupling);
    for (const Index j : soft) left.push_back(pinned_[at(j)]);
    // Zero on the soft ones to the last bit.
    for (const Index i : left) held_.row(i).setZero();
    for (std::size_t j = 0; j < left.size(); ++j)
        for (std::size_t i = 0; i < left.size(); ++i) R_(left[i], static_cast<Index>(j)) = i == j;
}

DenseMatrix SoftModes::times_A(const DenseMatrix& X) const {
    DenseMatrix product(X.rows(), X.cols());
    ExtendedSums sums;
    Vector column;
    for (Index j = 0; j < X.cols(); ++j) {
        sums.start(Vector::Zero(X.rows()));
        sums.add(A_, false, 1, X.col(j));
        sums.end(column);
        product.col(j) = column;
    }
    return product;
}

void SoftModes::refine() {
    if (R_.cols() == 0) return;
    constexpr double rounding = std::numeric_limits<double>::epsilon();
    for (int round = 0; round < 4; ++round) {
        DenseMatrix correction = times_A(R_);
        solve(correction);
        R_ -= correction;
        if (correction.cwiseAbs().maxCoeff() <= rounding * R_.cwiseAbs().maxCoeff()) break;
    }
}

void SoftModes::sort_by_stiffness() {
    const Index k = R_.cols();
    if (k == 0) return;
    const DenseMatrix force = times_A(R_);
    DenseMatrix C(k, k);
    for (Index j = 0; j < k; ++j)
        for (Index i = 0; i <= j; ++i) C(i, j) = C(j, i) = extended_dot(R_.col(i), force.col(j));
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(C);
    const DenseMatrix length = R_.cwiseAbs();
    const DenseMatrix size = length.transpose() * absolute_times(A_, length);
    const Eigen::MatrixXd& Q = eigen.eigenvectors();
    stiffness_ = faint_ = eigen.eigenvalues();
    std::vector<Index> order(at(k));
    std::iota(order.begin(), order.end(), Index{0});
    for (Index j = 0; j < k; ++j) {
        const Vector share = Q.col(j).cwiseAbs();
        const double rounding = 4 * std::numeric_limits<double>::epsilon() * share.dot(size * share);
        if (stiffness_[j] < -rounding)
            throw NumericalError("A is " + A_.shape() + " and indefinite: a direction has negative stiffness");
        if (stiffness_[j] <= rounding) stiffness_[j] = 0;
    }
    std::stable_partition(order.begin(), order.end(), [&](Index j) { return stiffness_[j] == 0; });
    free_ = (stiffness_.array() == 0).count();
    R_ = DenseMatrix(R_ * Q)(Eigen::all, order).eval();
    stiffness_ = Vector(stiffness_(order));
    order.resize(at(free_));
    faint_ = Vector(faint_(order));
}

}  // namespace tact
