#include "tact/lib/row_runs.hpp"

#include <algorithm>
#include <cmath>

namespace tact {
namespace {

constexpr Index shortest_run = 8;

/// Whether the entries of two neighbouring rows stand at the same distances from the diagonal.
bool continues(const SparseMatrix& rows, Index row) {
    const auto* start = rows.outerIndexPtr();
    const auto* column = rows.innerIndexPtr();
    return start[row + 1] - start[row] == start[row] - start[row - 1] &&
           std::equal(column + start[row], column + start[row + 1], column + start[row - 1],
                      [](long here, long above) { return here == above + 1; });
}

/// One to four diagonals a pass: each pass loads and stores the sums.
template <int diagonals, class ValueAt>
void add_diagonals(Index count, double sign, const double* const* operand, ValueAt value_at, double* __restrict sum,
                   double* __restrict size) {
    for (Index i = 0; i < count; ++i) {
        double total = 0, absolute = 0;
        for (int k = 0; k < diagonals; ++k) {
            const double term = value_at(k, i) * operand[k][i];
            total += term;
            absolute += std::abs(term);
        }
        sum[i] += sign * total;
        size[i] += absolute;
    }
}

template <class ValueAt>
void add_diagonals(std::size_t diagonals, Index count, double sign, const double* x, const Index* distance,
                   ValueAt value_at, double* sum, double* size) {
    for (std::size_t done = 0; done < diagonals; done += 4) {
        const double* operand[4] = {};
        const auto left = std::min<std::size_t>(diagonals - done, 4);
        for (std::size_t k = 0; k < left; ++k) operand[k] = x + distance[done + k];
        const auto value = [&](int k, Index i) { return value_at(done + static_cast<std::size_t>(k), i); };
        if (left == 4)
            add_diagonals<4>(count, sign, operand, value, sum, size);
        else if (left == 3)
            add_diagonals<3>(count, sign, operand, value, sum, size);
        else if (left == 2)
            add_diagonals<2>(count, sign, operand, value, sum, size);
        else
            add_diagonals<1>(count, sign, operand, value, sum, size);
    }
}

}  // namespace

RowRuns::RowRuns(const SparseMatrix& transposed) {
    const Index rows = transposed.outerSize();
    for (Index block = 0; block < rows; block += block_rows) {
        const Index end = std::min(block + block_rows, rows);
        Index single = block;  // first row not stored yet
        for (Index first = block, next = 0; first < end; first = next) {
            for (next = first + 1; next < end && continues(transposed, next);) ++next;
            if (next - first < shortest_run) continue;
            if (first > single) add_single_rows(transposed, single, first - single);
            add_run(transposed, first, next - first);
            single = next;
        }
        if (end > single) add_single_rows(transposed, single, end - single);
        first_run_.push_back(runs_.size());
    }
}

void RowRuns::add_run(const SparseMatrix& transposed, Index first, Index count) {
    const auto begin = transposed.outerIndexPtr()[first];
    const auto entries = transposed.outerIndexPtr()[first + 1] - begin;
    const double* value = transposed.valuePtr() + begin;
    const bool equal = std::equal(value + entries, value + entries * count, value);
    runs_.push_back({equal ? Kind::equal_rows : Kind::diagonals, first, count, static_cast<std::size_t>(entries),
                     distance_.size(), value_.size()});
    for (long k = 0; k < entries; ++k) {
        distance_.push_back(transposed.innerIndexPtr()[begin + k] - first);
        for (Index i = 0; i < (equal ? 1 : count); ++i) value_.push_back(value[i * entries + k]);
    }
}

void RowRuns::add_single_rows(const SparseMatrix& transposed, Index first, Index count) {
    runs_.push_back({Kind::single_rows, first, count, 0, single_start_.size(), 0});
    for (Index i = first; i < first + count; ++i) {
        single_start_.push_back(single_column_.size());
        for (SparseMatrix::InnerIterator it(transposed, i); it; ++it) {
            single_column_.push_back(static_cast<int>(it.index()));
            single_value_.push_back(it.value());
        }
    }
    single_start_.push_back(single_column_.size());
}

void RowRuns::add(Index block, double sign, const double* x, double* sum, double* size) const {
    const auto b = static_cast<std::size_t>(block);
    for (auto r = first_run_[b]; r < first_run_[b + 1]; ++r) {
        const Run& run = runs_[r];
        const double* operand = x + run.first;
        const double* value = value_.data() + run.value;
        double* const s = sum + (run.first - block * block_rows);
        double* const z = size + (run.first - block * block_rows);
        if (run.kind == Kind::single_rows) {
            const std::size_t* start = single_start_.data() + run.start;
            for (Index i = 0; i < run.count; ++i)
                for (auto k = start[i]; k < start[i + 1]; ++k) {
                    const double term = single_value_[k] * x[single_column_[k]];
                    s[i] += sign * term;
                    z[i] += std::abs(term);
                }
        } else if (run.kind == Kind::diagonals) {
            const auto at = [value, count = run.count](std::size_t k, Index i) {
                return value[static_cast<Index>(k) * count + i];
            };
            add_diagonals(run.entries, run.count, sign, operand, distance_.data() + run.start, at, s, z);
        } else {
            const auto at = [value](std::size_t k, Index) { return value[k]; };
            add_diagonals(run.entries, run.count, sign, operand, distance_.data() + run.start, at, s, z);
        }
    }
}

}  // namespace tact
