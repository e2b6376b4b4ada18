// Which rows change sides from one active set to the next, so that the sets come to an end.
#pragma once

#include <cstdint>
#include <unordered_set>
#include <vector>

#include "../../lib/types.hpp"

namespace tact {

/// All wrong rows at once, as long as no set comes back: the primal-dual active set. Then all while they become fewer, and
/// the first one alone after three sets in which they did not: finite wherever each set has one solution and signs are told
/// from rounding. J. J. Judice, F. M. Pires, Comput. Oper. Res. 21 (1994); K. G. Murty, Linear Algebra Appl. 9 (1974).
class Exchanges {
public:
    void start();
    /// Whether a set has come back since start().
    bool careful() const { return careful_; }
    /// Changes `active` by the wrong rows, in ascending order; false if that is a set that was left before.
    bool apply(std::vector<char>& active, const std::vector<Index>& wrong);

private:
    static constexpr int patient = 3;
    std::unordered_set<std::uint64_t> visited_;
    bool careful_ = false;
    std::size_t fewest_ = 0;
    int patience_ = 0;
};

}  // namespace tact
