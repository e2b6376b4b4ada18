// Every integrator for problems of second order, each with a name for messages.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "../../integrators/bdf2_without_jump.hpp"
#include "../../integrators/central_difference.hpp"
#include "../../integrators/moreau_jean.hpp"
#include "../../integrators/sundials/arkode.hpp"
#include "../../integrators/sundials/bdf2.hpp"
#include "../../integrators/sundials/ida.hpp"
#include "../../integrators/trapezoid.hpp"

namespace tact::testing {

using NamedIntegrators = std::vector<std::pair<std::string, std::shared_ptr<const Integrator>>>;

inline NamedIntegrators every_integrator() {
    NamedIntegrators all{{"bdf2", std::make_shared<Bdf2>()},
                         {"bdf2-without-jump", std::make_shared<Bdf2WithoutJump>()},
                         {"bdf2-without-jump:e=0.5", std::make_shared<Bdf2WithoutJump>(0.5)},
                         {"central-difference", std::make_shared<CentralDifference>()},
                         {"central-difference:e=0.5", std::make_shared<CentralDifference>(0.5)},
                         {"trapezoid", std::make_shared<Trapezoid>()},
                         {"trapezoid:e=0.5", std::make_shared<Trapezoid>(Trapezoid::Options{1, 0.5})},
                         {"trapezoid:rho=0.3", std::make_shared<Trapezoid>(Trapezoid::Options{0.3, 0})},
                         {"moreau-jean", std::make_shared<MoreauJean>()},
                         {"ida", std::make_shared<Ida>()},
                         {"ida-fixed", std::make_shared<Ida>(Ida::fixed_step())}};
    for (const ButcherTable& table : {sdirk2(), tr_bdf2(), esdirk32(), sdirk54()}) {
        all.emplace_back(table.name, std::make_shared<Arkode>(table));
        all.emplace_back(table.name + ", adaptive", std::make_shared<Arkode>(table, Arkode::Options{}));
    }
    return all;
}

}  // namespace tact::testing
