#include "tact/lib/sparse/aggregation.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>

namespace tact {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// Sums of sparse rows: values by column, and which columns they hold. Without branches: which column is new is as
/// good as random, and a wrong guess costs more than the sum.
class SparseSum {
public:
    explicit SparseSum(int columns) : sum_(at(columns)), column_(at(columns) + 1) {}

    void add(int column, double value) {
        Sum& sum = sum_[at(column)];
        column_[count_] = column;
        count_ += sum.fresh;
        sum.fresh = 0;
        sum.value += value;
    }
    /// Becomes the next row.
    void append_to(CompressedRows& rows) {
        const auto first = rows.column.size();
        rows.column.insert(rows.column.end(), column_.begin(), column_.begin() + static_cast<std::ptrdiff_t>(count_));
        rows.value.resize(first + count_);
        for (std::size_t k = 0; k < count_; ++k) {
            Sum& sum = sum_[at(column_[k])];
            rows.value[first + k] = sum.value;
            sum = {};
        }
        rows.start.push_back(static_cast<int>(first + count_));
        count_ = 0;
    }

private:
    struct Sum {
        double value = 0;
        std::uint32_t fresh = 1;  // (of another type than count_, which then stays in a register)
    };
    std::vector<Sum> sum_;
    std::vector<int> column_;
    std::size_t count_ = 0;
};

CompressedRows without_rows(int columns) {
    CompressedRows rows;
    rows.columns = columns;
    rows.start.push_back(0);
    return rows;
}

/// Unknowns by the length of their rows, the given numbering among equals.
std::vector<int> by_degree(const CompressedRows& A) {
    std::vector<int> first;
    const auto degree = [&](int i) { return at(A.end(i) - A.begin(i)); };
    for (int i = 0; i < A.rows; ++i) {
        if (degree(i) + 2 > first.size()) first.resize(degree(i) + 2, 0);
        ++first[degree(i) + 1];
    }
    std::partial_sum(first.begin(), first.end(), first.begin());
    std::vector<int> sorted(at(A.rows));
    for (int i = 0; i < A.rows; ++i) sorted[at(first[degree(i)]++)] = i;
    return sorted;
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

bool symmetric_in_place(const CompressedRows& A, double tolerance) {
    if (A.rows != A.columns) return false;
    double largest = 0;
    for (const double a : A.value) largest = std::max(largest, std::abs(a));
    // Rows in turn meet the entries of every column in its row's order.
    std::vector<int> cursor(A.start.begin(), A.start.end() - 1);
    for (int i = 0; i < A.rows; ++i)
        for (int k = A.begin(i); k < A.end(i); ++k) {
            const int j = A.column_at(k);
            const int mirror = cursor[at(j)]++;
            if (mirror >= A.end(j) || A.column_at(mirror) != i) return false;
            if (!(std::abs(A.value_at(k) - A.value_at(mirror)) <= tolerance * largest)) return false;
        }
    return true;
}

std::vector<double> diagonal_of(const CompressedRows& A) {
    std::vector<double> diagonal(at(A.rows), 0.0);
    for (int i = 0; i < A.rows; ++i)
        for (int k = A.begin(i); k < A.end(i); ++k)
            if (A.column_at(k) == i) diagonal[at(i)] += A.value_at(k);
    return diagonal;
}

std::vector<int> wave_order(const CompressedRows& A) {
    int equal = 0;
    for (int i = 0; i + 1 < A.rows; ++i) {
        const int length = A.end(i) - A.begin(i);
        equal += A.end(i + 1) - A.begin(i + 1) == length &&
                 std::equal(A.column.begin() + A.begin(i), A.column.begin() + A.end(i),
                            A.column.begin() + A.begin(i + 1), [](int j, int next) { return next == j + 1; });
    }
    if (2 * equal >= A.rows) return {};
    std::vector<int> order;
    order.reserve(at(A.rows));
    std::vector<char> seen(at(A.rows), 0);
    std::size_t next = 0;
    // A search reaches one part of the graph; it starts at a corner, so that its waves are short.
    for (const int start : by_degree(A)) {
        if (seen[at(start)]) continue;
        seen[at(start)] = 1;
        order.push_back(start);
        for (; next < order.size(); ++next) {
            const auto first = static_cast<std::ptrdiff_t>(order.size());
            for (int k = A.begin(order[next]); k < A.end(order[next]); ++k) {
                const int j = A.column_at(k);
                if (seen[at(j)]) continue;
                seen[at(j)] = 1;
                order.push_back(j);
            }
            std::sort(order.begin() + first, order.end(), [&](int i, int j) {
                const int a = A.end(i) - A.begin(i), b = A.end(j) - A.begin(j);
                return a != b ? a < b : i < j;
            });
        }
    }
    return order;
}

CompressedRows permuted(const CompressedRows& A, const std::vector<int>& order) {
    std::vector<int> position(order.size());
    for (int i = 0; i < A.rows; ++i) position[at(order[at(i)])] = i;
    CompressedRows rows;
    rows.rows = rows.columns = A.rows;
    rows.start.resize(A.start.size());
    rows.column.resize(A.column.size());
    rows.value.resize(A.value.size());
    std::size_t entry = 0;
    for (int i = 0; i < A.rows; ++i) {
        const int old = order[at(i)];
        const auto first = entry;
        for (int k = A.begin(old); k < A.end(old); ++k, ++entry) {
            // Sorted by insertion: rows are short.
            const int column = position[at(A.column_at(k))];
            auto slot = entry;
            for (; slot > first && rows.column[slot - 1] > column; --slot) {
                rows.column[slot] = rows.column[slot - 1];
                rows.value[slot] = rows.value[slot - 1];
            }
            rows.column[slot] = column;
            rows.value[slot] = A.value_at(k);
        }
        rows.start[at(i) + 1] = static_cast<int>(entry);
    }
    return rows;
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
    const auto grow = [&](int i) {
        of[at(i)] = static_cast<int>(aggregates.root.size());
        for (int k = A.begin(i); k < A.end(i); ++k)
            if (strong(i, k) && of[at(A.column_at(k))] < 0) of[at(A.column_at(k))] = of[at(i)];
        aggregates.root.push_back(i);
    };
    // Whole neighbourhoods first,
    for (int i = 0; i < A.rows; ++i) {
        if (of[at(i)] >= 0) continue;
        bool coupled = false, free = true;
        for (int k = A.begin(i); free && k < A.end(i); ++k)
            if (strong(i, k)) {
                coupled = true;
                free = of[at(A.column_at(k))] < 0;
            }
        if (coupled && free) grow(i);
    }
    // then what is left between them joins the neighbour it is coupled to most,
    const std::vector<int> whole = of;
    for (int i = 0; i < A.rows; ++i) {
        if (of[at(i)] >= 0) continue;
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
        if (of[at(i)] >= 0) continue;
        bool coupled = false;
        for (int k = A.begin(i); !coupled && k < A.end(i); ++k) coupled = strong(i, k);
        if (coupled) grow(i);
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
    const double omega = 4.0 / 3.0 / radius;
    CompressedRows P = without_rows(static_cast<int>(aggregates.root.size()));
    P.rows = A.rows;
    P.start.reserve(at(A.rows) + 1);
    P.column.reserve(3 * at(A.rows));
    P.value.reserve(3 * at(A.rows));
    SparseSum sum(P.columns);
    for (int i = 0; i < A.rows; ++i) {
        if (aggregates.of[at(i)] >= 0) sum.add(aggregates.of[at(i)], 1);
        for (int k = A.begin(i); k < A.end(i); ++k) {
            const int aggregate = aggregates.of[at(A.column_at(k))];
            if (aggregate >= 0) sum.add(aggregate, -omega / diagonal[at(i)] * A.value_at(k));
        }
        sum.append_to(P);
    }
    return P;
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
    CompressedRows AP = without_rows(P.columns);
    AP.rows = A.rows;
    AP.start.reserve(at(A.rows) + 1);
    AP.column.reserve(2 * P.column.size());
    AP.value.reserve(2 * P.column.size());
    SparseSum sum(P.columns);
    for (int i = 0; i < A.rows; ++i) {
        for (int k = A.begin(i); k < A.end(i); ++k)
            for (int l = P.begin(A.column_at(k)); l < P.end(A.column_at(k)); ++l)
                sum.add(P.column_at(l), A.value_at(k) * P.value_at(l));
        sum.append_to(AP);
    }
    CompressedRows coarse = without_rows(P.columns);
    coarse.rows = P.columns;
    for (int J = 0; J < P.columns; ++J) {
        for (int k = P_transposed.begin(J); k < P_transposed.end(J); ++k)
            for (int l = AP.begin(P_transposed.column_at(k)); l < AP.end(P_transposed.column_at(k)); ++l)
                sum.add(AP.column_at(l), P_transposed.value_at(k) * AP.value_at(l));
        sum.append_to(coarse);
    }
    return coarse;
}

}  // namespace tact
