// Integrators by name.
#pragma once

#include <memory>
#include <string_view>

#include "tact/lib/integrator.hpp"

namespace tact::bench {

/// "bdf2". InputError for another name.
std::unique_ptr<Integrator> integrator(std::string_view name);

}  // namespace tact::bench
