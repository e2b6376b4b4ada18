#include "gram.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>

namespace tact {

DenseMatrix gram(const Eigen::Ref<const DenseMatrix>& X) {
    constexpr Index block_rows = 512;
    DenseMatrix G = DenseMatrix::Zero(X.cols(), X.cols());
    for (Index i = 0; i < X.rows(); i += block_rows)
        G.selfadjointView<Eigen::Lower>().rankUpdate(X.middleRows(i, std::min(block_rows, X.rows() - i)).transpose());
    G.triangularView<Eigen::StrictlyUpper>() = G.transpose();
    return G;
}

GramEigen gram_eigen(const DenseMatrix& G) {
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(G);
    return {solver.eigenvectors().rowwise().reverse(), solver.eigenvalues().reverse().cwiseMax(0).cwiseSqrt()};
}

}  // namespace tact
