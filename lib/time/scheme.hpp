// How a problem is marched, in one value.
#pragma once

#include <string_view>

#include "integrator.hpp"

namespace tact {

/// Integrator, grid and contact solver: `Scheme{Trapezoid{}, TimeGrid::until(1, 1e-3)}`. Integrator and contact solver go in
/// by value or by shared_ptr; an empty one is whoever runs the scheme's usual choice.
struct Scheme {
    Shared<Integrator> integrator = {};
    TimeGrid grid = {};
    Shared<ContactSolver> contact = {};

    /// Both by name, as the door's registry reads them (component tact, door/registry.hpp): named("trapezoid:e=0", grid).
    /// InputError that gives the nearest name, and all of them, for an unknown one; options likewise.
    static Scheme named(std::string_view integrator, const TimeGrid& grid, std::string_view contact = "automatic");
};

}  // namespace tact
