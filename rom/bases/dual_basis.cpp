#include "dual_basis.hpp"

#include <algorithm>

#include "../model/orthonormal.hpp"
#include "dual_basis_input.hpp"
#include "singular_pairs.hpp"

namespace tact {

DualBasis snapshot_cone() {
    return [](const DualBasisInput& input) {
        const NonNegativeBlock X = checked_snapshots(input);
        const Index wanted = std::min(input.size, X.cols());
        std::vector<Index> columns;
        for (Index k = 0; k < wanted; ++k)
            columns.push_back(X.column_places()[static_cast<std::size_t>(k * X.cols() / wanted)]);
        DualBasisResult result;
        result.U_lambda = unit_columns(input.snapshots, columns);
        return result;
    };
}

DualBasis nnmf_basis(NnmfOptions options) {
    return [options = std::move(options)](const DualBasisInput& input) {
        const NonNegativeBlock X = checked_snapshots(input);
        DualBasisResult result = empty_dual_basis(input);
        const Index rank = std::min(input.size, X.cols());
        if (rank < 1) return result;
        NnmfOptions told = options;
        told.observer = [&](int sweep, double residual) {
            const bool proceed = report(input, static_cast<double>(sweep) / options.max_sweeps);
            return (!options.observer || options.observer(sweep, residual)) && proceed;
        };
        Nnmf factors = nnmf(input.snapshots, rank, told);
        result.U_lambda = std::move(factors.U_lambda);
        result.outcome = factors.outcome;
        result.residuals = std::move(factors.residuals);
        result.warning = decay_warning(X, rank);
        return result;
    };
}

DualBasis touched_rows() {
    return [](const DualBasisInput& input) {
        DualBasisResult result;
        result.U_lambda = unit_vectors(input.snapshots.rows(), checked_snapshots(input).row_places());
        return result;
    };
}

DualBasis singular_vectors() {
    return [](const DualBasisInput& input) {
        const NonNegativeBlock X = checked_snapshots(input);
        DualBasisResult result = empty_dual_basis(input);
        result.signs = DualSigns::any;
        const Index rank = std::min({input.size, X.rows(), X.cols()});
        if (rank < 1) return result;
        DenseMatrix vectors = orthonormal_columns(leading_singular_pairs(X, rank).scaled_left);
        fix_signs(vectors);
        result.U_lambda.setZero(input.snapshots.rows(), vectors.cols());
        result.U_lambda(X.row_places(), Eigen::all) = vectors;
        result.warning = decay_warning(X, rank);
        return result;
    };
}

}  // namespace tact
