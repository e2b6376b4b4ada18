#include "dual_basis_input.hpp"

#include <algorithm>
#include <cmath>

#include "singular_pairs.hpp"

namespace tact {
namespace {

constexpr double slow_decay = 0.1;  // of the norm left: the dual basis then decides the error of the reduced problem

std::string shape(Index rows, Index cols) { return std::to_string(rows) + "x" + std::to_string(cols); }

}  // namespace

NonNegativeBlock checked_snapshots(const DualBasisInput& input) {
    if (input.snapshots.rows() != input.B.rows())
        throw InputError("DualBasisInput: snapshots is " + shape(input.snapshots.rows(), input.snapshots.cols()) +
                         ", expected " + std::to_string(input.B.rows()) + " rows");
    if (input.U.rows() != input.B.cols())
        throw InputError("DualBasisInput: U is " + shape(input.U.rows(), input.U.cols()) + ", expected " +
                         std::to_string(input.B.cols()) + " rows");
    if (input.size < 0)
        throw InputError("DualBasisInput: size is " + std::to_string(input.size) + ", expected at least 0");
    return NonNegativeBlock(input.snapshots);
}

DualBasisResult empty_dual_basis(const DualBasisInput& input) {
    DualBasisResult result;
    result.U_lambda.resize(input.snapshots.rows(), 0);
    return result;
}

bool report(const DualBasisInput& input, double fraction) { return !input.progress || input.progress(fraction); }

DenseMatrix snapshot_gram(const SparseMatrix& X, const std::vector<Index>& columns) {
    SparseMatrix chosen(X.rows(), static_cast<Index>(columns.size()));
    for (std::size_t j = 0; j < columns.size(); ++j) {
        chosen.startVec(static_cast<Index>(j));
        for (SparseMatrix::InnerIterator it(X, columns[j]); it; ++it)
            chosen.insertBack(it.row(), static_cast<Index>(j)) = it.value();
    }
    chosen.finalize();
    return DenseMatrix(SparseMatrix(chosen.transpose()) * chosen);
}

DenseMatrix unit_columns(const SparseMatrix& X, const std::vector<Index>& columns) {
    DenseMatrix result = DenseMatrix::Zero(X.rows(), static_cast<Index>(columns.size()));
    for (std::size_t j = 0; j < columns.size(); ++j)
        for (SparseMatrix::InnerIterator it(X, columns[j]); it; ++it)
            result(it.row(), static_cast<Index>(j)) = it.value();
    for (Index j = 0; j < result.cols(); ++j) result.col(j).stableNormalize();
    return result;
}

DenseMatrix unit_vectors(Index size, const std::vector<Index>& rows) {
    DenseMatrix result = DenseMatrix::Zero(size, static_cast<Index>(rows.size()));
    for (std::size_t j = 0; j < rows.size(); ++j) result(rows[j], static_cast<Index>(j)) = 1;
    return result;
}

std::string decay_warning(const NonNegativeBlock& X, Index rank) {
    const Index r = std::min({rank, X.rows(), X.cols()});
    if (r < 1) return {};
    const double kept = leading_singular_pairs(X, r).scaled_left.norm() / X.norm();
    const double left = std::sqrt(std::max(1 - kept * kept, 0.0));
    if (!(left > slow_decay)) return {};
    return "the dual snapshots compress badly: the best " + std::to_string(r) + " vectors leave " +
           std::to_string(static_cast<int>(std::lround(100 * left))) +
           " % of their norm; take more, or contact at selected rows";
}

}  // namespace tact
