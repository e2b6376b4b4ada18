#include "ida.hpp"

#include <utility>

#include "../../lib/time/naming.hpp"
#include "../impact.hpp"
#include "../step_control.hpp"
#include "ida_run.hpp"

namespace tact {

Ida::Ida(const Options& options) : options_(options) {
    check_step_control("Ida", options);
    check_restitution("Ida", options.restitution);
    if (options.max_order < 1 || options.max_order > 5)
        throw InputError("Ida: max_order is " + std::to_string(options.max_order) + ", expected from 1 to 5");
}

Ida Ida::fixed_step() {
    Ida ida;
    ida.fixed_ = true;
    ida.options_.most_steps = 0;
    return ida;
}

std::string Ida::name() const {
    if (fixed_) return "ida-fixed";
    WithOptions name("ida");
    add_step_control(name, options_);
    name.add_unless(2, "order", options_.max_order);
    return name.text();
}

std::unique_ptr<Run> Ida::start(const Shared<ContactProblem>& problem, const TimeGrid& grid,
                                const ContactWorkspace& workspace) const {
    require_contact_rows("Ida", *problem);
    if (problem->is_static()) throw InputError("Ida: the problem has neither M nor D, expected one; use QuasiStatic");
    if (options_.restitution && !problem->second_order())
        throw InputError("Ida: restitution on a problem without M, expected none");
    if (options_.newton && problem->constraints() > 0)
        throw InputError("Ida: newton with " + std::to_string(problem->constraints()) +
                         " contact constraints, expected none; leave it off");
    return sundials::ida_run(problem, grid, workspace, options_, fixed_);
}

}  // namespace tact
