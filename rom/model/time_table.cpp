#include "time_table.hpp"

#include <algorithm>
#include <cmath>

namespace tact {

void TimeTable::evaluate(double t, Side side, VectorRef out) const {
    constexpr double on_a_point = 1e-6;
    const double place = std::clamp((t - grid.t0) / grid.dt, 0.0, static_cast<double>(grid.steps));
    const auto nearest = static_cast<Index>(std::lround(place));
    if (std::abs(place - static_cast<double>(nearest)) <= on_a_point) {
        out = (side == Side::left ? left : right).col(nearest);
        return;
    }
    const auto before = static_cast<Index>(std::floor(place));
    const double share = place - static_cast<double>(before);
    out = (1 - share) * right.col(before) + share * left.col(before + 1);
}

TimeTable tabulate(const AffineVector& functions, const TimeGrid& grid, long refinement) {
    TimeTable table;
    if (functions.constant()) return table;
    if (functions.is_function())
        throw InputError(
            "tabulate: a function of its full size has no coefficients; expected modes * coefficients(t)");
    validate(grid);
    table.grid = {grid.dt / static_cast<double>(refinement), grid.steps * refinement, grid.t0};
    table.jumps = functions.jumps;
    for (const double jump : table.jumps) {
        const double place = (jump - grid.t0) / table.grid.dt;
        if (place > 0 && place < static_cast<double>(table.grid.steps) && std::abs(place - std::round(place)) > 1e-6)
            throw InputError("tabulate: a jump is at t = " + shown(jump) + ", expected on the grid; refine it");
    }
    const Index count = functions.mode_count(), points = table.grid.steps + 1;
    for (DenseMatrix* side : {&table.left, &table.right}) side->resize(count, points);
    for (Index n = 0; n < points; ++n) {
        // t_n as the integrator forms it, where both have it.
        const double t = n % refinement == 0 ? grid.t(n / refinement) : table.grid.t(n);
        functions.coefficients(t, Side::left, table.left.col(n));
        functions.coefficients(t, Side::right, table.right.col(n));
    }
    return table;
}

}  // namespace tact
