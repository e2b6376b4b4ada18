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

/// Unknowns of one node, where A's numbering has them together, else 1: the largest block size whose blocks are mostly full. On a
/// regular mesh of bricks symmetry empties 37 % of the 3 x 3 blocks; a scalar mesh read by pairs has them half empty.
Index unknowns_of_a_node(const SparseMatrix& A);

}  // namespace tact
