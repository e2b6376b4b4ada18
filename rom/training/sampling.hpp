// Points in a box of parameters.
#pragma once

#include <cstdint>
#include <vector>

#include "tact/lib/contact_family.hpp"

namespace tact {

/// Where the points of a uniform grid lie: in the middle of equal cells, or with the box's faces among them.
enum class GridKind { cell_centred, closed };

/// The tensor grid with counts[k] points in parameter k; the first parameter varies fastest. InputError unless the box
/// is finite with lower <= upper, there is one count per parameter and each is at least 1 (closed: 2).
std::vector<Parameter> tensor_grid(const Parameter& lower, const Parameter& upper, const std::vector<Index>& counts,
                                   GridKind kind = GridKind::cell_centred);

/// `count` points of which each of `count` equal slices of each parameter holds exactly one, placed at random in it
/// (McKay, Beckman, Conover, Technometrics 21, 1979). GSL's mt19937: the same points for the same seed (0 is GSL's
/// default seed, 4357). InputError unless the box is finite with lower <= upper and count is at least 1.
std::vector<Parameter> latin_hypercube(const Parameter& lower, const Parameter& upper, Index count,
                                       std::uint32_t seed);

/// The index of the point nearest the centre of the box, distances in units of its sides; the first of equals.
/// InputError without points.
Index nearest_to_centre(const std::vector<Parameter>& points, const Parameter& lower, const Parameter& upper);

}  // namespace tact
