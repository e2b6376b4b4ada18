// The extremes of many numbers, eight at a time: what certificates take of vectors.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "../types.hpp"

namespace tact::lane_ranges {

inline constexpr Index lanes = 8;
typedef double Lanes __attribute__((vector_size(sizeof(double) * lanes)));  // NOLINT: `using` takes no attribute

inline Lanes load(const double* x) {
    Lanes v;
    std::memcpy(&v, x, sizeof v);
    return v;
}
/// `count` numbers, zeros after them.
inline Lanes load(const double* x, Index count) {
    Lanes v = {};
    std::memcpy(&v, x, sizeof(double) * static_cast<std::size_t>(count));
    return v;
}

/// The range of some numbers and zero; a NaN among them makes it infinite.
class Range {
public:
    void take(const double* x, Index count) {
        Index i = 0;
        for (; i + 2 * lanes <= count; i += 2 * lanes) {
            raise(0, load(x + i));
            raise(1, load(x + i + lanes));
        }
        for (; i < count; i += lanes) raise(0, load(x + i, std::min(lanes, count - i)));
    }
    /// `way` is 0 or 1.
    void take(const Lanes& v, int way) { raise(way, v); }
    double highest() const { return fold(highest_[0] > highest_[1] ? highest_[0] : highest_[1]); }
    double lowest() const { return -fold(lowest_[0] < lowest_[1] ? -lowest_[0] : -lowest_[1]); }
    double largest() const { return std::max(highest(), -lowest()); }

private:
    void raise(int way, const Lanes& v) {
        highest_[way] = v > highest_[way] ? v : highest_[way];
        lowest_[way] = v < lowest_[way] ? v : lowest_[way];
        sum_[way] += v;  // keeps every NaN; a comparison drops it
    }
    double fold(const Lanes& best) const {
        const Lanes sums = sum_[0] + sum_[1];
        double largest = 0, sum = 0;
        for (Index l = 0; l < lanes; ++l) {
            largest = std::max(largest, best[l]);
            sum += sums[l];
        }
        return std::isnan(sum) ? infinity : largest;
    }
    // Two ways, because each comparison waits for the one before.
    Lanes highest_[2] = {}, lowest_[2] = {}, sum_[2] = {};
};

typedef long Bits __attribute__((vector_size(sizeof(double) * lanes)));  // NOLINT

inline Lanes size_of(const Lanes& v) {
    return reinterpret_cast<Lanes>(reinterpret_cast<Bits>(v) & std::numeric_limits<long>::max());
}

/// One of the lanes after `pair` has made one of two, three times.
template <class Pair> double fold(Lanes v, const Pair& pair) {
    v = pair(v, __builtin_shufflevector(v, v, 4, 5, 6, 7, 0, 1, 2, 3));
    v = pair(v, __builtin_shufflevector(v, v, 2, 3, 0, 1, 6, 7, 4, 5));
    v = pair(v, __builtin_shufflevector(v, v, 1, 0, 3, 2, 5, 4, 7, 6));
    return v[0];
}

inline double total(const Lanes& v) {
    return fold(v, [](const Lanes& a, const Lanes& b) -> Lanes { return a + b; });
}

/// The largest size of some numbers; a NaN among them makes it infinite.
class Largest {
public:
    /// `way` is 0 or 1: two ways, because each comparison waits for the one before.
    void take(const Lanes& v, int way = 0) {
        const Lanes size = size_of(v);
        largest_[way] = size > largest_[way] ? size : largest_[way];
        sum_[way] += size;
    }
    void take(const double* x, Index count) {
        Index i = 0;
        for (; i + lanes <= count; i += lanes) take(load(x + i));
        if (i < count) take(load(x + i, count - i));
    }
    double value() const {
        const auto larger = [](const Lanes& a, const Lanes& b) -> Lanes { return a > b ? a : b; };
        return std::isnan(total(sum_[0] + sum_[1])) ? infinity : fold(larger(largest_[0], largest_[1]), larger);
    }

private:
    Lanes largest_[2] = {}, sum_[2] = {};
};

}  // namespace tact::lane_ranges
