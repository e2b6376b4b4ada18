// Integrators by name.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "../../lib/time/registry.hpp"

namespace tact::bench {

/// tact's own registry (door/registry.hpp), and the peers that are linked in: contact solver "ipopt". "chooser" is what
/// results call "automatic".
const Registry& registry();

/// A name, and after a colon its options: "trapezoid:rho=0.3,e=0". InputError as Registry::integrator.
Shared<Integrator> integrator(std::string_view text);
std::vector<std::string> integrator_names();

}  // namespace tact::bench
