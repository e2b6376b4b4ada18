// Points in a box of parameters.
#pragma once

#include <cstdint>
#include <vector>

#include "../../lib/problem/contact_family.hpp"

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

/// The first points of Sobol's sequence, from the box's centre on (its origin left out), in up to 40 parameters: every 2^k
/// of them fill the box evenly (GSL; Antonov, Saleev, USSR Comput. Math. Math. Phys. 19, 1980). InputError as above, or
/// for more parameters.
std::vector<Parameter> sobol_sequence(const Parameter& lower, const Parameter& upper, Index count);

/// The first points of Halton's sequence, of which parameter k has the digits of 1, 2, 3, ... in the k-th prime base
/// reversed (Halton, Numer. Math. 2, 1960); in up to 1229 parameters, good in the first dozen. InputError as above.
std::vector<Parameter> halton_sequence(const Parameter& lower, const Parameter& upper, Index count);

/// The index of the point nearest the centre of the box, distances in units of its sides; the first of equals.
/// InputError without points.
Index nearest_to_centre(const std::vector<Parameter>& points, const Parameter& lower, const Parameter& upper);

}  // namespace tact
