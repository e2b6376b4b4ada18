#include "numbering.hpp"

#include <algorithm>
#include <cstdlib>
#include <numeric>

namespace tact {
namespace {

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

bool reads_well(const SparseMatrix& A) {
    const auto* start = A.outerIndexPtr();
    const auto* row = A.innerIndexPtr();
    Index continued = 0, distances = 0;
    for (Index j = 0; j < A.cols(); ++j) {
        const auto length = start[j + 1] - start[j];
        for (auto k = start[j]; k < start[j + 1]; ++k) distances += std::abs(row[k] - j);
        continued += j > 0 && start[j] - start[j - 1] == length &&
                     std::equal(row + start[j], row + start[j + 1], row + start[j - 1],
                                [](long i, long last) { return i == last + 1; });
    }
    return 2 * continued >= A.cols() || 16 * distances <= A.cols() * A.nonZeros();
}

/// Unknowns by the length of their columns, the given numbering among equals.
std::vector<int> by_degree(const SparseMatrix& A) {
    const auto* start = A.outerIndexPtr();
    std::vector<int> first;
    const auto degree = [&](Index j) { return at(start[j + 1] - start[j]); };
    for (Index j = 0; j < A.cols(); ++j) {
        if (degree(j) + 2 > first.size()) first.resize(degree(j) + 2, 0);
        ++first[degree(j) + 1];
    }
    std::partial_sum(first.begin(), first.end(), first.begin());
    std::vector<int> sorted(at(A.cols()));
    for (Index j = 0; j < A.cols(); ++j) sorted[at(first[degree(j)]++)] = static_cast<int>(j);
    return sorted;
}

/// The transpose of A(order, order): a scatter that goes through the new numbers in turn leaves columns sorted.
SparseMatrix renumbered_transpose(const SparseMatrix& A, const std::vector<int>& order) {
    const auto* start = A.outerIndexPtr();
    const auto* row = A.innerIndexPtr();
    const auto* value = A.valuePtr();
    const auto place = inverse_of(order);
    SparseMatrix result(A.cols(), A.rows());
    result.resizeNonZeros(A.nonZeros());
    auto* next = result.outerIndexPtr();
    std::fill_n(next, A.rows() + 1, 0);
    for (Index k = 0; k < A.nonZeros(); ++k) ++next[place[at(row[k])] + 1];
    std::partial_sum(next, next + A.rows() + 1, next);
    for (Index j = 0; j < A.cols(); ++j) {
        constexpr Index ahead = 16;  // columns, which stand anywhere
        if (j + ahead < A.cols()) {
            const auto coming = start[order[at(j + ahead)]];
            __builtin_prefetch(row + coming);
            __builtin_prefetch(value + coming);
        }
        const Index old = order[at(j)];
        for (auto k = start[old]; k < start[old + 1]; ++k) {
            const auto to = next[place[at(row[k])]]++;
            result.innerIndexPtr()[to] = j;
            result.valuePtr()[to] = value[k];
        }
    }
    std::copy_backward(next, next + A.rows(), next + A.rows() + 1);
    next[0] = 0;
    return result;
}

}  // namespace

Waves wave_order(const SparseMatrix& A) {
    if (reads_well(A)) return {};
    const auto* start = A.outerIndexPtr();
    const auto* row = A.innerIndexPtr();
    Waves waves;
    std::vector<int>& order = waves.order;
    order.reserve(at(A.cols()));
    std::vector<char> seen(at(A.cols()), 0);
    std::size_t next = 0;
    // A search reaches one part of the graph; it starts at a corner, so that its waves are short.
    for (const int corner : by_degree(A)) {
        if (seen[at(corner)]) continue;
        seen[at(corner)] = 1;
        order.push_back(corner);
        for (; next < order.size(); ++next) {
            const auto first = static_cast<std::ptrdiff_t>(order.size());
            for (auto k = start[order[next]]; k < start[order[next] + 1]; ++k) {
                if (seen[at(row[k])]) continue;
                seen[at(row[k])] = 1;
                order.push_back(static_cast<int>(row[k]));
                __builtin_prefetch(row + start[row[k]]);  // read a wave later
            }
            std::sort(order.begin() + first, order.end(), [&](int i, int j) {
                const auto a = start[i + 1] - start[i], b = start[j + 1] - start[j];
                return a != b ? a < b : i < j;
            });
        }
        waves.parts.push_back(static_cast<int>(order.size()));
    }
    return waves;
}

std::vector<int> inverse_of(const std::vector<int>& order) {
    std::vector<int> place(order.size());
    for (std::size_t i = 0; i < order.size(); ++i) place[at(order[i])] = static_cast<int>(i);
    return place;
}

Matrix renumbered(const SparseMatrix& A, const std::vector<int>& order) {
    Matrix transposed(renumbered_transpose(A, order));
    return transposed.is_symmetric(0) ? transposed : Matrix(SparseMatrix(transposed.sparse()->transpose()));
}

Index unknowns_of_a_node(const SparseMatrix& A) {
    constexpr double full = 0.55;
    const Index n = A.cols();
    std::vector<Index> seen;
    for (Index size = 6; size > 1; --size) {
        if (n % size != 0) continue;
        seen.assign(static_cast<std::size_t>(n / size), -1);
        Index blocks = 0;
        for (Index j = 0; j < n; ++j)
            for (auto k = A.outerIndexPtr()[j]; k < A.outerIndexPtr()[j + 1]; ++k) {
                Index& last = seen[static_cast<std::size_t>(A.innerIndexPtr()[k] / size)];
                blocks += last != j / size;
                last = j / size;
            }
        if (static_cast<double>(A.nonZeros()) > full * static_cast<double>(blocks * size * size)) return size;
    }
    return 1;
}

}  // namespace tact
