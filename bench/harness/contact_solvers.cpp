#include "contact_solvers.hpp"

#include "../../contact/automatic.hpp"
#include "../../contact/dense/dense_contact.hpp"
#include "../../contact/dense/orthogonal_contact.hpp"
#include "../../contact/strategies/colour_sor.hpp"
#include "../../contact/strategies/klu_active_set.hpp"
#include "../../contact/strategies/multigrid_active_set.hpp"
#include "../../contact/strategies/projected_cg.hpp"
#include "../../contact/strategies/schur_contact.hpp"
#include "../peers/interior_point.hpp"

namespace tact::bench {

const std::vector<NamedSolver>& contact_solvers() {
    static const std::vector<NamedSolver> all = [] {
        std::vector<NamedSolver> solvers{
            {"chooser", std::make_shared<AutomaticContact>()}, {"klu-active-set", std::make_shared<KluActiveSet>()},
            {"schur", std::make_shared<SchurContact>()},       {"projected-cg", std::make_shared<ProjectedCg>()},
            {"colour-sor", std::make_shared<ColourSor>()},     {"multigrid", std::make_shared<MultigridActiveSet>()},
            {"dense", std::make_shared<DenseContact>()},       {"orthogonal", std::make_shared<OrthogonalContact>()},
        };
        if (auto ipopt = interior_point()) solvers.push_back({"ipopt", std::move(ipopt), true});
        return solvers;
    }();
    return all;
}

std::shared_ptr<const ContactSolver> contact_solver(std::string_view name) {
    std::string names;
    for (const NamedSolver& each : contact_solvers()) {
        if (each.name == name) return each.solver;
        names += (names.empty() ? "" : ", ") + each.name;
    }
    throw InputError("contact_solver: name is " + std::string(name) + ", expected one of " + names);
}

}  // namespace tact::bench
