// Linear elements on the line: what every one-dimensional scene is assembled from.
#pragma once

#include <initializer_list>
#include <utility>

#include "../problem/matrix.hpp"

namespace tact {

/// Of finite elements: rows summed onto the diagonal, or the full element matrix h/6 (2, 1; 1, 2).
enum class Mass { lumped, consistent };

/// int modulus u' w' over [0, length] in `elements` equal linear elements with both ends free: tridiagonal, (elements
/// + 1) square, rows summing to zero. A fixed end is left out by taking the block of the others.
SparseMatrix line_stiffness(Index elements, double length, double modulus);
/// int density u w; sparse in either kind.
SparseMatrix line_mass(Index elements, double length, double density, Mass mass);
/// The problem's M: diagonal where it is lumped.
Matrix mass_matrix(SparseMatrix entries, Mass mass);
/// One row with the given entries: (column, value).
SparseMatrix single_row(Index columns, std::initializer_list<std::pair<Index, double>> entries);

/// InputError "`object`: `field` is `value`, expected `expected`" unless it is finite and `ok`.
void check_data(const char* object, const char* field, double value, bool ok, const char* expected);
void check_elements(const char* object, Index elements, Index at_least = 1);

}  // namespace tact
