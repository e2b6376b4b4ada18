// The toolkit's few numeric types. Everything else is built from these.
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <limits>

namespace tact {

using Index = Eigen::Index;
/// Columns of numbers and dense matrices, as Eigen::VectorXd and Eigen::MatrixXd but for one thing: their memory comes from
/// malloc and goes back to free whatever the compiler's flags are. Eigen's own types get theirs from another allocator under
/// AVX, so that an object made in a program and destroyed in a library must not be one of them. Any Eigen expression
/// converts, by a copy, and so does Eigen::VectorXd from a Vector.
using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::DontAlign>;
using DenseMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::DontAlign>;
/// Compressed columns with `long` indices: what KLU's and CHOLMOD's long interfaces read without a copy.
using SparseMatrix = Eigen::SparseMatrix<double, Eigen::ColMajor, long>;
/// Views, without a copy, of any column of numbers in one piece, Eigen::VectorXd included.
using VectorRef = Eigen::Ref<Vector>;
using ConstVectorRef = Eigen::Ref<const Vector>;

inline constexpr double infinity = std::numeric_limits<double>::infinity();

}  // namespace tact
