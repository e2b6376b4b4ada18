// Contact solvers by name: every strategy, the chooser, and the interior point where it was built in.
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

/// "chooser" first, then the strategies, then the peers that are linked in.
const std::vector<NamedSolver>& contact_solvers();

/// InputError that lists the names for another one.
std::shared_ptr<const ContactSolver> contact_solver(std::string_view name);

}  // namespace tact::bench
