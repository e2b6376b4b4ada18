// Numberings of unknowns in which neighbours on the mesh are neighbours in memory.
#pragma once

#include <vector>

#include "../problem/matrix.hpp"

namespace tact {

/// An order of unknowns, one connected part of the graph after the other.
struct Waves {
    std::vector<int> order;     ///< old number of each new one
    std::vector<int> parts{0};  ///< where each part begins, and the end of the last
};

/// Numbers unknowns by breadth-first waves (Cuthill, McKee, Proc. ACM 1969). The order is empty if the given
/// numbering reads well already: most neighbouring columns of A have their entries at equal distances from the diagonal, or
/// entries stand nearer to it than a sixteenth of the unknowns on average. A is square, its pattern about symmetric.
Waves wave_order(const SparseMatrix& A);

/// The new number of each old one.
std::vector<int> inverse_of(const std::vector<int>& order);

/// A(order, order), columns sorted; A square.
Matrix renumbered(const SparseMatrix& A, const std::vector<int>& order);

}  // namespace tact
