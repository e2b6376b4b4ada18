// Integrators by name.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "../../lib/time/integrator.hpp"

namespace tact::bench {

/// A name, and after a colon its options as NAME=NUMBER with commas between them:
///   bdf2, bdf2-without-jump[:e=], trapezoid[:rho=,e=], central-difference[:e=], moreau-jean[:theta=,e=], quasi-static,
///   ida[:rtol=,atol=,order=,e=], ida-fixed, and sdirk2, tr-bdf2, esdirk32, sdirk54 [:e=], fixed or, with rtol=,atol=, adaptive.
/// InputError that lists the names, or the options of that name.
std::unique_ptr<Integrator> integrator(std::string_view name);
std::vector<std::string> integrator_names();

}  // namespace tact::bench
