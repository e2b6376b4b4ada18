#include "aggregation.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <numeric>
#include <utility>

namespace tact {
namespace {

/// Strong neighbours up to which an aggregate takes more than these.
constexpr std::size_t few_neighbours = 6;
/// Of the prolongator, over the bound of the spectral radius. 4/3 minimises a bound of the energy; with up to 2 the
/// columns of a five-point stencil come nearer to bilinear, and a cycle reduces the error by 5 instead of 3.5.
constexpr double smoothing = 1.8;

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// Sparse rows in storage that nobody has filled with zeros first, which costs as much as the sums themselves.
struct RowBuffer {
    std::vector<int> start{0};
    std::unique_ptr<int[]> column;
    std::unique_ptr<double[]> value;
    std::size_t capacity = 0;

    void reserve(std::size_t entries) {
        if (entries <= capacity) return;
        capacity = std::max(entries, 2 * capacity);
        auto columns = std::make_unique_for_overwrite<int[]>(capacity);
        auto values = std::make_unique_for_overwrite<double[]>(capacity);
        std::copy_n(column.get(), at(start.back()), columns.get());
        std::copy_n(value.get(), at(start.back()), values.get());
        column = std::move(columns);
        value = std::move(values);
    }
    CompressedRows compressed(int columns) const {
        CompressedRows rows;
        rows.rows = static_cast<int>(start.size()) - 1;
        rows.columns = columns;
        rows.start = start;
        rows.column.assign(column.get(), column.get() + start.back());
        rows.value.assign(value.get(), value.get() + start.back());
        return rows;
    }
};

/// Rows of sums, one after the other. Without branches: which column is new is as good as random, and a wrong guess
/// costs more than the sum.
class RowSums {
public:
    RowSums(int rows, int columns, std::size_t expected) : sum_(at(columns)) {
        rows_.start.reserve(at(rows) + 1);
        rows_.reserve(expected);
    }

    /// The row that is summed next has at most so many terms.
    void start_row(std::size_t terms) {
        rows_.reserve(at(rows_.start.back()) + terms);
        next_ = rows_.column.get() + rows_.start.back();
    }
    void add(int column, double value) {
        Sum& sum = sum_[at(column)];
        *next_ = column;
        next_ += sum.fresh;
        sum.fresh = 0;
        sum.value += value;
    }
    void end_row() {
        const auto end = static_cast<int>(next_ - rows_.column.get());
        for (auto k = at(rows_.start.back()); k < at(end); ++k) {
            Sum& sum = sum_[at(rows_.column[k])];
            rows_.value[k] = sum.value;
            sum = {};
        }
        rows_.start.push_back(end);
    }
    RowBuffer finish() { return std::move(rows_); }

private:
    struct Sum {
        double value = 0;
        std::uint32_t fresh = 1;
    };
    std::vector<Sum> sum_;
    RowBuffer rows_;
    int* next_ = nullptr;
};

/// A B.
template <class Left, class Right>
RowBuffer product(int rows, const Left& A, const Right& B, int columns, std::size_t expected) {
    RowSums sums(rows, columns, expected);
    for (std::size_t i = 0; i < at(rows); ++i) {
        const auto begin = at(A.start[i]), end = at(A.start[i + 1]);
        std::size_t terms = 0;
        for (auto k = begin; k < end; ++k) terms += at(B.start[at(A.column[k]) + 1] - B.start[at(A.column[k])]);
        sums.start_row(terms);
        for (auto k = begin; k < end; ++k) {
            const auto row = at(A.column[k]);
            const double a = A.value[k];
            for (auto l = at(B.start[row]); l < at(B.start[row + 1]); ++l) sums.add(B.column[l], a * B.value[l]);
        }
        sums.end_row();
    }
    return sums.finish();
}

}  // namespace

CompressedRows compressed_columns(const SparseMatrix& A) {
    CompressedRows rows;
    rows.rows = static_cast<int>(A.cols());
    rows.columns = static_cast<int>(A.rows());
    rows.start.assign(A.outerIndexPtr(), A.outerIndexPtr() + A.outerSize() + 1);
    rows.column.assign(A.innerIndexPtr(), A.innerIndexPtr() + A.nonZeros());
    rows.value.assign(A.valuePtr(), A.valuePtr() + A.nonZeros());
    return rows;
}

std::vector<double> diagonal_of(const CompressedRows& A) {
    std::vector<double> diagonal(at(A.rows), 0.0);
    for (int i = 0; i < A.rows; ++i)
        for (int k = A.begin(i); k < A.end(i); ++k)
            if (A.column_at(k) == i) {
                diagonal[at(i)] = A.value_at(k);
                break;
            }
    return diagonal;
}

std::vector<int> greedy_colours(const CompressedRows& A) {
    std::vector<int> colour(at(A.rows), -1), taken_by;
    for (int i = 0; i < A.rows; ++i) {
        for (int k = A.begin(i); k < A.end(i); ++k) {
            const int c = colour[at(A.column_at(k))];
            if (c >= 0) taken_by[at(c)] = i;
        }
        const auto free = std::find_if(taken_by.begin(), taken_by.end(), [&](int by) { return by != i; });
        colour[at(i)] = static_cast<int>(free - taken_by.begin());
        if (free == taken_by.end()) taken_by.push_back(-1);
    }
    return colour;
}

Aggregates aggregates_of(const CompressedRows& A, const std::vector<double>& diagonal, double strength) {
    const auto strong = [&](int i, int k) {
        const int j = A.column_at(k);
        const double a = A.value_at(k);
        return j != i && a * a > strength * strength * diagonal[at(i)] * diagonal[at(j)];
    };
    Aggregates aggregates;
    auto& of = aggregates.of;
    of.assign(at(A.rows), -1);
    // The neighbours of an unknown and, where these are few, what two of them reach: the 3 x 3 nodes of a five-point
    // stencil. Stars of five would make the next level half as large again, and irregular.
    std::vector<int> reached;
    std::vector<char> paths(at(A.rows), 0);
    const auto reach_from = [&](int i) {
        reached.clear();
        for (int k = A.begin(i); k < A.end(i); ++k)
            if (strong(i, k)) reached.push_back(A.column_at(k));
        const auto neighbours = reached.size();
        for (const int j : reached) paths[at(j)] = 2;
        for (std::size_t q = 0; neighbours <= few_neighbours && q < neighbours; ++q) {
            const int j = reached[q];
            for (int k = A.begin(j); k < A.end(j); ++k) {
                char& count = paths[at(A.column_at(k))];
                if (count == 2 || A.column_at(k) == i || !strong(j, k)) continue;
                if (++count == 1) reached.push_back(A.column_at(k));
            }
        }
        std::erase_if(reached, [&](int j) { return std::exchange(paths[at(j)], char{0}) < 2; });
    };
    const auto grow = [&](int i) {
        of[at(i)] = static_cast<int>(aggregates.root.size());
        for (const int j : reached)
            if (of[at(j)] < 0) of[at(j)] = of[at(i)];
        aggregates.root.push_back(i);
    };
    const auto is_free = [&](int j) { return of[at(j)] < 0; };
    // Whole neighbourhoods first,
    for (int i = 0; i < A.rows; ++i) {
        bool free = is_free(i);
        for (int k = A.begin(i); free && k < A.end(i); ++k) free = !strong(i, k) || is_free(A.column_at(k));
        if (!free) continue;
        reach_from(i);
        if (!reached.empty() && std::all_of(reached.begin(), reached.end(), is_free)) grow(i);
    }
    // then what is left between them joins the neighbour it is coupled to most,
    const std::vector<int> whole = of;
    for (int i = 0; i < A.rows; ++i) {
        if (!is_free(i)) continue;
        double most = 0;
        for (int k = A.begin(i); k < A.end(i); ++k) {
            const int j = A.column_at(k);
            const double coupling = std::abs(A.value_at(k)) / std::sqrt(diagonal[at(j)]);
            if (whole[at(j)] >= 0 && strong(i, k) && coupling > most) {
                most = coupling;
                of[at(i)] = whole[at(j)];
            }
        }
    }
    // and the rest, if coupled at all, among themselves.
    for (int i = 0; i < A.rows; ++i) {
        if (!is_free(i)) continue;
        reach_from(i);
        if (!reached.empty()) grow(i);
    }
    return aggregates;
}

CompressedRows smoothed_prolongator(const CompressedRows& A, const std::vector<double>& diagonal,
                                    const Aggregates& aggregates) {
    double radius = 0;
    for (int i = 0; i < A.rows; ++i) {
        double sum = 0;
        for (int k = A.begin(i); k < A.end(i); ++k) sum += std::abs(A.value_at(k));
        radius = std::max(radius, sum / diagonal[at(i)]);
    }
    RowSums P(A.rows, static_cast<int>(aggregates.root.size()), 3 * at(A.rows));
    for (int i = 0; i < A.rows; ++i) {
        P.start_row(at(A.end(i) - A.begin(i)) + 1);
        if (aggregates.of[at(i)] >= 0) P.add(aggregates.of[at(i)], 1);
        const double weight = -smoothing / radius / diagonal[at(i)];
        for (int k = A.begin(i); k < A.end(i); ++k) {
            const int aggregate = aggregates.of[at(A.column_at(k))];
            if (aggregate >= 0) P.add(aggregate, weight * A.value_at(k));
        }
        P.end_row();
    }
    return P.finish().compressed(static_cast<int>(aggregates.root.size()));
}

CompressedRows transposed(const CompressedRows& A) {
    CompressedRows T;
    T.rows = A.columns;
    T.columns = A.rows;
    T.start.assign(at(A.columns) + 1, 0);
    for (const int j : A.column) ++T.start[at(j) + 1];
    std::partial_sum(T.start.begin(), T.start.end(), T.start.begin());
    T.column.resize(A.column.size());
    T.value.resize(A.value.size());
    std::vector<int> next(T.start.begin(), T.start.end() - 1);
    for (int i = 0; i < A.rows; ++i)
        for (int k = A.begin(i); k < A.end(i); ++k) {
            const auto slot = at(next[at(A.column_at(k))]++);
            T.column[slot] = i;
            T.value[slot] = A.value_at(k);
        }
    return T;
}

CompressedRows galerkin_product(const CompressedRows& A, const CompressedRows& P,
                                const CompressedRows& P_transposed) {
    const RowBuffer AP = product(A.rows, A, P, P.columns, 2 * P.column.size());
    return product(P.columns, P_transposed, AP, P.columns, P.column.size()).compressed(P.columns);
}

}  // namespace tact
