#include "contact_solvers.hpp"

#include <algorithm>

#include "methods.hpp"

namespace tact::bench {

const std::vector<NamedSolver>& contact_solvers() {
    static const std::vector<NamedSolver> all = [] {
        std::vector<NamedSolver> solvers;
        for (const char* name :
             {"chooser", "klu-active-set", "schur", "projected-cg", "colour-sor", "multigrid", "dense", "orthogonal"})
            solvers.push_back({name, contact_solver(name)});
        const std::vector<std::string> names = registry().contacts();
        if (std::ranges::find(names, "ipopt") != names.end())
            solvers.push_back({"ipopt", contact_solver("ipopt"), true});
        return solvers;
    }();
    return all;
}

std::shared_ptr<const ContactSolver> contact_solver(std::string_view name) { return registry().contact(name); }

}  // namespace tact::bench
