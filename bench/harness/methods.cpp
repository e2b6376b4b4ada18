#include "methods.hpp"

#include "../../contact/automatic.hpp"
#include "../../door/registry.hpp"
#include "../peers/interior_point.hpp"

namespace tact::bench {

const Registry& registry() {
    static const Registry all = [] {
        Registry made = tact::registry();
        made.add_contact("chooser", [](NamedOptions&) { return AutomaticContact(); });
        if (interior_point()) made.add_contact("ipopt", [](NamedOptions&) { return interior_point(); });
        return made;
    }();
    return all;
}

Shared<Integrator> integrator(std::string_view text) { return registry().integrator(text); }
std::vector<std::string> integrator_names() { return registry().integrators(); }

}  // namespace tact::bench
