// The toolkit's few numeric types. Everything else is built from these.
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <limits>

namespace tact {

using Index = Eigen::Index;
using Vector = Eigen::VectorXd;
using DenseMatrix = Eigen::MatrixXd;
/// Compressed columns with `long` indices: what KLU's and CHOLMOD's long interfaces read without a copy.
using SparseMatrix = Eigen::SparseMatrix<double, Eigen::ColMajor, long>;
using VectorRef = Eigen::Ref<Vector>;
using ConstVectorRef = Eigen::Ref<const Vector>;

inline constexpr double infinity = std::numeric_limits<double>::infinity();

}  // namespace tact
