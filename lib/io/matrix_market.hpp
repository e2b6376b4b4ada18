// Matrices and vectors as text: Matrix Market coordinate files, and vectors with one number a line.
#pragma once

#include <filesystem>

#include "../problem/matrix.hpp"

namespace tact {

/// Reads `%%MatrixMarket matrix coordinate real general` or `... real symmetric` (`integer` too); of a symmetric matrix
/// the file holds the lower half and the result both. Indices count from 1; entries are finite, each place at most once.
/// InputError that names the file and the line for anything else, and for a file that cannot be read.
SparseMatrix read_matrix_market(const std::filesystem::path& path);

/// Reads one number a line; `inf` and `-inf` are numbers, NaN is not. Blank lines do not count. InputError as above.
Vector read_vector(const std::filesystem::path& path);

}  // namespace tact
