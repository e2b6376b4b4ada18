#include "tact/bench/methods.hpp"

#include "tact/integrators/bdf2.hpp"
#include "tact/lib/errors.hpp"

namespace tact::bench {

std::unique_ptr<Integrator> integrator(std::string_view name) {
    if (name == "bdf2") return std::make_unique<Bdf2>();
    throw InputError("integrator: name is " + std::string(name) + ", expected bdf2");
}

}  // namespace tact::bench
