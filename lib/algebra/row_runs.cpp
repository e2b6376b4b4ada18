#include "row_runs.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace tact {
namespace {

/// Whether the entries of two neighbouring rows stand at the same distances from the diagonal.
bool continues(const SparseMatrix& rows, Index row) {
    const auto* start = rows.outerIndexPtr();
    const auto* column = rows.innerIndexPtr();
    return start[row + 1] - start[row] == start[row] - start[row - 1] &&
           std::equal(column + start[row], column + start[row + 1], column + start[row - 1],
                      [](long here, long above) { return here == above + 1; });
}

constexpr Index lanes = 8;
typedef double Lanes __attribute__((vector_size(sizeof(double) * lanes)));  // NOLINT: `using` takes no attribute here
typedef long Bits __attribute__((vector_size(sizeof(double) * lanes)));     // NOLINT

void load(const double* x, Lanes& v) { std::memcpy(&v, x, sizeof(v)); }
void store(double* x, const Lanes& v) { std::memcpy(x, &v, sizeof(v)); }

/// `value_at(k, i, v)` loads what diagonal k holds in the rows from i on. A run has at least `lanes` rows: the last step
/// goes back over some that are done and adds nothing to them.
template <bool with_size, class ValueAt>
void add_diagonals(std::size_t diagonals, Index count, double factor, const double* x, const Index* distance,
                   ValueAt value_at, double* sum, double* size) {
    const Bits without_sign = Bits{} + std::numeric_limits<long>::max();
    const Bits lane = {0, 1, 2, 3, 4, 5, 6, 7};
    Bits wanted = without_sign | ~without_sign;
    for (Index i = 0; i < count; i += lanes) {
        if (i + lanes > count) {
            wanted = lane >= i + lanes - count;
            i = count - lanes;
        }
        Lanes total = {}, absolute = {}, value, operand;
        for (std::size_t k = 0; k < diagonals; ++k) {
            value_at(k, i, value);
            load(x + distance[k] + i, operand);
            const Lanes term = value * operand;
            total += term;
            if constexpr (with_size) absolute += reinterpret_cast<Lanes>(reinterpret_cast<Bits>(term) & without_sign);
        }
        Lanes before;
        load(sum + i, before);
        store(sum + i, before + factor * reinterpret_cast<Lanes>(reinterpret_cast<Bits>(total) & wanted));
        if constexpr (with_size) {
            load(size + i, before);
            store(size + i, before + reinterpret_cast<Lanes>(reinterpret_cast<Bits>(absolute) & wanted));
        }
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
            if (next - first < lanes) continue;
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

template <bool with_size>
void RowRuns::add_block(Index block, double factor, const double* x, double* sum, double* size) const {
    const auto b = static_cast<std::size_t>(block);
    for (auto r = first_run_[b]; r < first_run_[b + 1]; ++r) {
        const Run& run = runs_[r];
        const double* operand = x + run.first;
        const double* value = value_.data() + run.value;
        const Index* distance = distance_.data() + run.start;
        double* const s = sum + (run.first - block * block_rows);
        double* const z = with_size ? size + (run.first - block * block_rows) : nullptr;
        if (run.kind == Kind::single_rows) {
            const std::size_t* start = single_start_.data() + run.start;
            for (Index i = 0; i < run.count; ++i)
                for (auto k = start[i]; k < start[i + 1]; ++k) {
                    const double term = single_value_[k] * x[single_column_[k]];
                    s[i] += factor * term;
                    if constexpr (with_size) z[i] += std::abs(term);
                }
        } else if (run.kind == Kind::diagonals) {
            const auto at = [value, count = run.count](std::size_t k, Index i, Lanes& v) {
                load(value + static_cast<Index>(k) * count + i, v);
            };
            add_diagonals<with_size>(run.entries, run.count, factor, operand, distance, at, s, z);
        } else {
            const auto at = [value](std::size_t k, Index, Lanes& v) { v = value[k] - Lanes{}; };
            add_diagonals<with_size>(run.entries, run.count, factor, operand, distance, at, s, z);
        }
    }
}

void RowRuns::add(Index block, double sign, const double* x, double* sum, double* size) const {
    add_block<true>(block, sign, x, sum, size);
}

void RowRuns::add_product(double factor, const double* x, double* sum) const {
    for (Index block = 0; block + 1 < static_cast<Index>(first_run_.size()); ++block)
        add_block<false>(block, factor, x, sum + block * block_rows, nullptr);
}

RepeatedProduct::RepeatedProduct(const Matrix& A) : A_(A) {
    if (const SparseMatrix* entries = A.sparse()) runs_ = RowRuns(entries->transpose());
}

void RepeatedProduct::add(double factor, const ConstVectorRef& x, VectorRef y) const {
    if (A_.sparse())
        runs_.add_product(factor, x.data(), y.data());
    else
        A_.multiply(x, y, factor, 1);
}

}  // namespace tact
