#include "pinned_unknowns.hpp"

#include <algorithm>
#include <cmath>

#include "../../lib/sparse/numbering.hpp"

namespace tact {
namespace {

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

/// distance[i] := the smaller of itself and the number of edges from `start`; returns what was reached, nearest first.
std::vector<Index> walk(const SparseMatrix& A, Index start, std::vector<int>& distance) {
    std::vector<Index> reached{start};
    std::vector<int> own(1, 0);
    distance[at(start)] = 0;
    for (std::size_t k = 0; k < reached.size(); ++k)
        for (SparseMatrix::InnerIterator it(A, reached[k]); it; ++it)
            if (own[k] + 1 < distance[at(it.row())]) {
                distance[at(it.row())] = own[k] + 1;
                reached.push_back(it.row());
                own.push_back(own[k] + 1);
            }
    return reached;
}

}  // namespace

std::vector<Index> softest_pivots(DenseMatrix A, double soft) {
    const Index n = A.rows();
    Vector pivot = A.diagonal();
    std::vector<Index> left(at(n));
    for (Index i = 0; i < n; ++i) left[at(i)] = i;
    DenseMatrix L(n, n);
    for (Index k = 0; !left.empty(); ++k) {
        const auto largest =
            std::max_element(left.begin(), left.end(), [&](Index i, Index j) { return pivot[i] < pivot[j]; });
        const Index q = *largest;
        if (!(pivot[q] > soft)) break;
        L.col(k) = A.col(q);
        L.col(k).noalias() -= L.leftCols(k) * L.row(q).head(k).transpose();
        L.col(k) /= std::sqrt(pivot[q]);
        left.erase(largest);
        for (const Index i : left) pivot[i] -= L(i, k) * L(i, k);
    }
    return left;
}

std::vector<Index> without_stiffness(const Matrix& A) {
    const Vector diagonal = A.main_diagonal();
    std::vector<Index> unknowns;
    for (Index i = 0; i < diagonal.size(); ++i)
        if (diagonal[i] == 0) unknowns.push_back(i);
    return unknowns;
}

std::vector<Index> unknowns_far_apart(const Matrix& A) {
    constexpr std::size_t most_parts = 8;
    constexpr int unreached = std::numeric_limits<int>::max();
    std::vector<Index> unknowns = without_stiffness(A);
    const SparseMatrix& graph = *A.sparse();
    std::vector<int> distance(at(A.rows()), unreached);
    for (const Index i : unknowns) distance[at(i)] = 0;
    std::vector<std::vector<Index>> parts;
    for (Index i = 0; i < A.rows(); ++i) {
        if (distance[at(i)] != unreached) continue;
        parts.push_back(walk(graph, i, distance));
        if (parts.size() > most_parts) return unknowns;
    }
    const Index size = unknowns_of_a_node(graph);
    const int places = static_cast<int>(std::clamp<Index>(24 / size, 8, 12));
    for (const auto& part : parts) {
        for (const Index i : part) distance[at(i)] = unreached;
        Index farthest = part.back();
        for (int place = 0; place < places; ++place) {
            for (Index i = farthest / size * size; i < (farthest / size + 1) * size; ++i) unknowns.push_back(i);
            (void)walk(graph, farthest, distance);
            farthest = *std::max_element(part.begin(), part.end(), [&](Index i, Index j) {
                return distance[at(i)] != distance[at(j)] ? distance[at(i)] < distance[at(j)] : i > j;
            });
            if (distance[at(farthest)] == 0) break;
        }
    }
    std::sort(unknowns.begin(), unknowns.end());
    unknowns.erase(std::unique(unknowns.begin(), unknowns.end()), unknowns.end());
    return unknowns;
}

}  // namespace tact
