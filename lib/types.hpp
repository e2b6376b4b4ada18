// The toolkit's few numeric types. Everything else is built from these.
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <limits>

namespace tact {

using Index = Eigen::Index;
/// Where a Vector's memory comes from. Eigen's own types get theirs from an allocator that hangs on the compiler's flags, so that
/// an object made in a program and destroyed in a library compiled otherwise must not be one of them: here it is malloc and
/// free, whatever the flags. A build for one machine (TACT_NATIVE) has one set of flags, asks them of its users, and keeps
/// Eigen's: aligned for the widest vectors, so that the order of sums hangs on no address.
#ifdef TACT_NATIVE_MEMORY
inline constexpr int memory = Eigen::ColMajor;
#else
inline constexpr int memory = Eigen::DontAlign;
#endif
/// Columns of numbers and dense matrices. Any Eigen expression converts, by a copy, and so does Eigen::VectorXd from a Vector.
using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, memory>;
using DenseMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, memory>;
/// Compressed columns with `long` indices: what KLU's and CHOLMOD's long interfaces read without a copy.
using SparseMatrix = Eigen::SparseMatrix<double, Eigen::ColMajor, long>;
/// Views, without a copy, of any column of numbers in one piece, Eigen::VectorXd included.
using VectorRef = Eigen::Ref<Vector>;
using ConstVectorRef = Eigen::Ref<const Vector>;

inline constexpr double infinity = std::numeric_limits<double>::infinity();

}  // namespace tact
