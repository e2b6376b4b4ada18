// What ColourSor does in single precision: sweeps over the unknowns colour by colour, and the way there and back.
#pragma once

#include <vector>

#include "../../lib/sparse/aggregation.hpp"
#include "../../lib/sparse/sliced_rows.hpp"

namespace tact {

/// Numbers with `padding` more on both sides, as SlicedRows wants its operands.
template <class T> class Padded {
public:
    void resize(Index n, T value = 0) { numbers_.setConstant(n + 2 * padding, value); }
    T* data() { return numbers_.data() + padding; }
    const T* data() const { return numbers_.data() + padding; }
    T& operator[](Index i) { return data()[i]; }

private:
    static constexpr int padding = SlicedRows<T>::padding;
    Eigen::Matrix<T, Eigen::Dynamic, 1> numbers_;  // aligned for the widest vectors
};

/// Reads and writes slices of neighbouring unknowns at their places in another order. Where a mesh is numbered along its
/// lines, or by wave fronts, the places by colour are one run or two that take turns, and move as vectors.
class Places {
public:
    using Slice = SlicedRows<float>::Lanes::Part;

    Places() = default;
    /// place[i] of unknown i.
    explicit Places(std::vector<int> place);
    void write(int slice, const Slice& from, float* to) const {
        const int* place = &place_[static_cast<std::size_t>(slice) * lanes];
        const Kind kind = kind_[static_cast<std::size_t>(slice)];
        if (kind == Kind::one_run) {
            std::memcpy(to + place[0], &from, sizeof(from));
        } else if (kind == Kind::two_runs) {
            const Half even = __builtin_shufflevector(from, from, 0, 2, 4, 6, 8, 10, 12, 14);
            const Half odd = __builtin_shufflevector(from, from, 1, 3, 5, 7, 9, 11, 13, 15);
            std::memcpy(to + place[0], &even, sizeof(even));
            std::memcpy(to + place[1], &odd, sizeof(odd));
        } else {
            for (int l = 0; l < lanes; ++l) to[place[l]] = from[l];
        }
    }
    void read(int slice, const float* from, Slice& to) const {
        const int* place = &place_[static_cast<std::size_t>(slice) * lanes];
        const Kind kind = kind_[static_cast<std::size_t>(slice)];
        if (kind == Kind::one_run) {
            to = SlicedRows<float>::load_part(from + place[0]);
        } else if (kind == Kind::two_runs) {
            Half even, odd;
            std::memcpy(&even, from + place[0], sizeof(even));
            std::memcpy(&odd, from + place[1], sizeof(odd));
            to = __builtin_shufflevector(even, odd, 0, 8, 1, 9, 2, 10, 3, 11, 4, 12, 5, 13, 6, 14, 7, 15);
        } else {
            for (int l = 0; l < lanes; ++l) to[l] = from[place[l]];
        }
    }

private:
    static constexpr int lanes = SlicedRows<float>::lanes;
    static_assert(SlicedRows<float>::Lanes::parts == 1);
    typedef float Half __attribute__((vector_size(sizeof(float) * lanes / 2)));  // NOLINT: `using` takes no attribute
    enum class Kind : unsigned char { one_run, two_runs, scattered };
    std::vector<int> place_;
    std::vector<Kind> kind_;
};

/// Projected over-relaxation for A d = r, lower <= d <= upper, by colours. Over-relaxation is the same for every scaling
/// of the unknowns; here rows are divided by the diagonal, r is over the diagonal too, and d keeps the scaling of u.
class ColourSweeps {
public:
    explicit ColourSweeps(const CompressedRows& A);

    /// Of the unknowns of A among r, lower, upper and d, which are in the order of colours.
    const Places& places() const { return places_; }
    void start_from_zero();
    /// d_i := min(max(d_i + omega (r - A d)_i, lower_i), upper_i) in turn; returns the largest change of a d_i.
    /// Without `from_above` there are no upper bounds.
    template <bool from_above> float sweep(float omega);

    Padded<float> r, lower, upper, d;

private:
    SlicedRows<float> couplings_;
    Places places_;
};

}  // namespace tact
