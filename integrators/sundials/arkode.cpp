#include "arkode.hpp"

#include <utility>

#include "../../lib/time/naming.hpp"
#include "../impact.hpp"
#include "../step_control.hpp"
#include "arkode_run.hpp"

namespace tact {

Arkode::Arkode(ButcherTable table, std::optional<double> restitution) : table_(std::move(table)), adaptive_(false) {
    validate(table_);
    options_.restitution = restitution;
    check_restitution("Arkode", restitution);
}

Arkode::Arkode(ButcherTable table, const Options& options)
    : table_(std::move(table)), options_(options), adaptive_(true) {
    validate(table_);
    check_restitution("Arkode", options.restitution);
    check_step_control("Arkode", options);
    if (table_.b_embedded.size() == 0)
        throw InputError("Arkode: table " + table_.name + " has no b_embedded, expected one for adaptive steps");
}

std::string Arkode::name() const {
    WithOptions name(table_.name);
    if (adaptive_)
        add_step_control(name, options_);
    else if (options_.restitution)
        name.add("e", *options_.restitution);
    return name.text();
}

std::unique_ptr<Run> Arkode::start(const Shared<ContactProblem>& problem, const TimeGrid& grid,
                                   const ContactWorkspace& workspace) const {
    if (problem->is_static())
        throw InputError("Arkode: the problem has neither M nor D, expected one; use QuasiStatic");
    if (options_.restitution && !problem->second_order())
        throw InputError("Arkode: restitution on a problem without M, expected none");
    if (problem->constraints() > 0) {
        if (!table_.stiffly_accurate())
            throw InputError("Arkode: table " + table_.name +
                             " is not stiffly accurate, expected its last row of A to be b under contact");
        if (options_.newton)
            throw InputError("Arkode: newton with " + std::to_string(problem->constraints()) +
                             " contact constraints, expected none; leave it off");
    }
    return sundials::arkode_run(problem, grid, workspace, table_, options_, adaptive_);
}

}  // namespace tact
