// The contact solvers that studies compare.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "../../lib/contact_solver.hpp"

namespace tact::bench {

struct NamedSolver {
    std::string name;
    std::shared_ptr<const ContactSolver> solver;
    bool peer = false;  ///< not ours
};

/// "chooser" first, then strategies of the registry, then the peers that are linked in.
const std::vector<NamedSolver>& contact_solvers();

/// Any of the registry (methods.hpp), as Registry::contact.
std::shared_ptr<const ContactSolver> contact_solver(std::string_view name);

}  // namespace tact::bench
