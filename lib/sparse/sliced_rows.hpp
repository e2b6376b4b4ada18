// Sparse rows in slices of sixteen, in single or double precision, built in one pass.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <type_traits>
#include <vector>

#include "../types.hpp"

namespace tact {

/// Rows in slices of `lanes`. Where the columns of a slice follow each other from lane to lane (meshes numbered along
/// lines, also colour by colour or by wave fronts) a slot keeps the first one only and reads its operand as one vector;
/// other slices gather. Operands are padded by `padding` numbers on both sides: a slot may reach past the ends with
/// zero weight. Made for matrices that are built as often as they are used: the pattern is found in one pass over the
/// entries without sorting, T = float halves the memory that a sweep moves, and slices with equal
/// values or equal gathers (relative to their first column) share them, so that a mesh of equal cells stays in cache.
template <class T> class SlicedRows {
public:
    static constexpr int lanes = 16;
    static constexpr int padding = 16;
    /// One number a lane, in parts that fill the widest vector registers: a wider vector type is lowered to scalars.
    struct Lanes {
        static constexpr int part_lanes = 64 / static_cast<int>(sizeof(T));
        static constexpr int parts = lanes / part_lanes;
        typedef T Part __attribute__((vector_size(64)));  // NOLINT: `using` takes no attribute here
        Part part[parts] = {};

        T operator[](int lane) const { return part[lane / part_lanes][lane % part_lanes]; }
        Lanes& operator+=(const Lanes& v) {
            for (int k = 0; k < parts; ++k) part[k] += v.part[k];
            return *this;
        }
        Lanes& operator-=(const Lanes& v) {
            for (int k = 0; k < parts; ++k) part[k] -= v.part[k];
            return *this;
        }
        Lanes& operator*=(const Lanes& v) {
            for (int k = 0; k < parts; ++k) part[k] *= v.part[k];
            return *this;
        }
        friend Lanes operator+(Lanes a, const Lanes& b) { return a += b; }
        friend Lanes operator-(Lanes a, const Lanes& b) { return a -= b; }
        friend Lanes operator*(Lanes a, const Lanes& b) { return a *= b; }
    };

private:
    struct Slice {
        std::uint32_t value, column, slots;  // column: in column_, or in gather_
        int first_column;
        bool gathers;
    };
    struct alignas(64) Values : std::array<T, lanes> {
        Values() : std::array<T, lanes>{} {}
    };
    using Columns = std::array<int, lanes>;

public:
    SlicedRows() = default;
    /// `fill(row, add)` calls add(column, value) for the entries of one row, at most `longest` of them; `rows` is a
    /// multiple of `lanes`.
    template <class Fill> SlicedRows(int rows, int longest, const Fill& fill) {
        scratch_.resize(static_cast<std::size_t>(longest) * lanes);
        runs_.resize(runs_for_a_gather * static_cast<std::size_t>(longest));
        run_values_.resize(runs_.size());
        slice_.reserve(static_cast<std::size_t>(rows / lanes));
        for (int first = 0; first < rows; first += lanes) {
            Entry* next = scratch_.data();
            Starts start{};
            for (int lane = 0; lane < lanes; ++lane) {
                fill(first + lane, [&next](int column, double value) { *next++ = {column, value}; });
                start[static_cast<std::size_t>(lane) + 1] = static_cast<std::size_t>(next - scratch_.data());
            }
            add_slice(start);
        }
        scratch_ = {};
        runs_ = {};
        run_values_ = {};
        seen_values_ = seen_gathers_ = {};
        value_.shrink_to_fit();
    }
    /// Whether no entry was rounded to T: these rows serve operands of higher precision too.
    bool exact() const { return exact_; }
    int slices() const { return static_cast<int>(slice_.size()); }

    static typename Lanes::Part load_part(const T* x) {
        typename Lanes::Part v;
        std::memcpy(&v, x, sizeof(v));
        return v;
    }
    static Lanes load(const T* x) {
        Lanes v;
        std::memcpy(static_cast<void*>(&v), x, sizeof(v));
        return v;
    }
    static void store(T* x, const Lanes& v) { std::memcpy(x, &v, sizeof(v)); }

    /// Reads the rows. A value to be held in a local variable: in a loop that stores, members would be loaded each time.
    class Reader {
    public:
        explicit Reader(const SlicedRows& rows)
            : slice_(rows.slice_.data()),
              value_(rows.value_.data()),
              column_(rows.column_.data()),
              gather_(rows.gather_.data()) {}

        /// (A x)_l for the rows of one slice, in the precision of the operand; x points at its number 0, padded.
        template <class X> void multiply_slice(int slice, const X* x, typename SlicedRows<X>::Lanes& sum) const {
            using Operand = SlicedRows<X>;
            const Slice& s = slice_[slice];
            const Values* value = value_ + s.value;
            if (!s.gathers) {
                // Part by part: a running sum of several registers would live in memory.
                const int* column = column_ + s.column;
                for (int part = 0; part < Operand::Lanes::parts; ++part) {
                    typename Operand::Lanes::Part even = {}, odd = {};
                    const int lane = part * Operand::Lanes::part_lanes;
                    const auto term = [&](std::size_t k) {
                        return part_as<X>(value[k].data() + lane) * Operand::load_part(x + column[k] + lane);
                    };
                    const std::size_t slots = s.slots;
                    std::size_t k = 0;
                    for (; k + 4 <= slots; k += 4) {
                        even += term(k);
                        odd += term(k + 1);
                        even += term(k + 2);
                        odd += term(k + 3);
                    }
                    for (; k < slots; ++k) even += term(k);
                    sum.part[part] = even + odd;
                }
            } else {
                // Kept a loop, GCC makes gathers of it: three times as fast as loads and inserts.
                alignas(64) X gathered[lanes] = {};
                const Columns* column = gather_ + s.column;
                x += s.first_column;
                for (unsigned k = 0; k < s.slots; ++k) {
#pragma GCC unroll 1
                    for (std::size_t l = 0; l < lanes; ++l) gathered[l] += value[k][l] * x[column[k][l]];
                }
                sum = Operand::load(gathered);
            }
        }

    private:
        const Slice* slice_;
        const Values* value_;
        const int* column_;
        const Columns* gather_;
    };
    Reader reader() const { return Reader(*this); }
    template <class X> void multiply_slice(int slice, const X* x, typename SlicedRows<X>::Lanes& sum) const {
        reader().multiply_slice(slice, x, sum);
    }

private:
    template <class X> static typename SlicedRows<X>::Lanes::Part part_as(const T* value) {
        using Wide = typename SlicedRows<X>::Lanes;
        typedef T Narrow __attribute__((vector_size(sizeof(T) * Wide::part_lanes)));  // NOLINT
        Narrow narrow;
        std::memcpy(&narrow, value, sizeof(narrow));
        return __builtin_convertvector(narrow, typename Wide::Part);
    }

    struct Entry {
        int column;
        double value;
    };
    /// A gathered slot costs about four runs, whose zeros are cheap to multiply.
    static constexpr std::size_t runs_for_a_gather = 3;

    using Starts = std::array<std::size_t, lanes + 1>;  // in scratch_, of the rows of a slice

    void add_slice(const Starts& start) {
        std::size_t longest = 0;
        for (std::size_t l = 0; l < lanes; ++l) longest = std::max(longest, start[l + 1] - start[l]);
        const auto value = value_.size();
        Slice slice{static_cast<std::uint32_t>(value), static_cast<std::uint32_t>(column_.size()), 0, 0, false};
        if (!add_runs(start, runs_for_a_gather * longest)) {
            slice.gathers = true;
            slice.first_column = scratch_[0].column;
            slice.column = static_cast<std::uint32_t>(gather_.size());
            value_.resize(value + longest);
            gather_.resize(gather_.size() + longest, Columns{});
            for (std::size_t l = 0; l < lanes; ++l)
                for (auto k = start[l]; k < start[l + 1]; ++k) {
                    value_[value + k - start[l]][l] = rounded(scratch_[k].value);
                    gather_[slice.column + k - start[l]][l] = scratch_[k].column - slice.first_column;
                }
            slice.column = shared(gather_, slice.column, seen_gathers_);
        }
        slice.slots = static_cast<std::uint32_t>(value_.size() - value);
        slice.value = shared(value_, slice.value, seen_values_);
        slice_.push_back(slice);
    }

    /// Neighbouring rows mostly have the same offsets in the same order: the next slot is tried first.
    bool add_runs(const Starts& start, std::size_t most) {
        std::size_t slots = 0;
        bool exact = true;
        for (std::size_t l = 0; l < lanes; ++l) {
            std::size_t slot = 0;
            for (auto k = start[l]; k < start[l + 1]; ++k, ++slot) {
                const int offset = scratch_[k].column - static_cast<int>(l);
                if (slot >= slots || runs_[slot] != offset)
                    for (slot = 0; slot < slots && runs_[slot] != offset;) ++slot;
                if (slot == slots) {
                    if (slots == most) return false;
                    runs_[slots] = offset;
                    run_values_[slots++] = {};
                }
                const T stored = static_cast<T>(scratch_[k].value);
                exact &= static_cast<double>(stored) == scratch_[k].value;
                run_values_[slot][l] += stored;
            }
        }
        exact_ &= exact;
        column_.insert(column_.end(), runs_.begin(), runs_.begin() + static_cast<std::ptrdiff_t>(slots));
        value_.insert(value_.end(), run_values_.begin(), run_values_.begin() + static_cast<std::ptrdiff_t>(slots));
        return true;
    }

    /// Where what was just appended stands already, if a slice with the same hash before it was equal.
    struct Seen {
        std::size_t first = 0, count = 0;
    };
    template <class Block>
    static std::uint32_t shared(std::vector<Block>& blocks, std::size_t first, std::vector<Seen>& seen) {
        const std::size_t count = blocks.size() - first, words = count * sizeof(Block) / sizeof(std::uint64_t);
        if (count == 0) return static_cast<std::uint32_t>(first);
        std::uint64_t hash = count;
        for (std::size_t k = 0; k < words; ++k) {
            std::uint64_t word;
            std::memcpy(&word, reinterpret_cast<const char*>(&blocks[first]) + k * sizeof(word), sizeof(word));
            hash = (hash ^ word) * 0x9e3779b97f4a7c15ULL;
        }
        if (seen.empty()) seen.resize(1024);
        Seen& same = seen[(hash >> 40) % seen.size()];
        if (same.count == count && std::memcmp(&blocks[same.first], &blocks[first], count * sizeof(Block)) == 0) {
            blocks.resize(first);
            return static_cast<std::uint32_t>(same.first);
        }
        same = {first, count};
        return static_cast<std::uint32_t>(first);
    }

    T rounded(double value) {
        const T stored = static_cast<T>(value);
        exact_ &= static_cast<double>(stored) == value;
        return stored;
    }

    bool exact_ = true;
    std::vector<Slice> slice_;
    std::vector<int> column_;      // per slot of a run
    std::vector<Columns> gather_;  // per gathered slot, relative to the slice's first column
    std::vector<Values> value_;    // per slot
    std::vector<Entry> scratch_;
    std::vector<int> runs_;           // of the slice that is being made: per slot its first column, as in column_
    std::vector<Values> run_values_;  // and its values
    std::vector<Seen> seen_values_, seen_gathers_;
};

}  // namespace tact
