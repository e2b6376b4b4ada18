#include "solve.hpp"

#include "../contact/automatic.hpp"

namespace tact {

StaticSolution solve(const ContactProblem& problem, const Shared<ContactSolver>& contact) {
    validate(problem);
    return solve_static(problem, ContactWorkspace(contact ? contact : AutomaticContact()));
}

}  // namespace tact
