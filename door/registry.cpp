#include "registry.hpp"

#include <limits>

#include "../contact/automatic.hpp"
#include "../contact/dense/dense_contact.hpp"
#include "../contact/dense/orthogonal_contact.hpp"
#include "../contact/strategies/colour_sor.hpp"
#include "../contact/strategies/diagonal_contact.hpp"
#include "../contact/strategies/floating_contact.hpp"
#include "../contact/strategies/interior_point.hpp"
#include "../contact/strategies/klu_active_set.hpp"
#include "../contact/strategies/multigrid_active_set.hpp"
#include "../contact/strategies/principal_pivoting.hpp"
#include "../contact/strategies/projected_cg.hpp"
#include "../contact/strategies/refined_contact.hpp"
#include "../contact/strategies/schur_contact.hpp"
#include "../integrators/bdf2_without_jump.hpp"
#include "../integrators/central_difference.hpp"
#include "../integrators/moreau_jean.hpp"
#include "../integrators/quasi_static.hpp"
#include "../integrators/sundials/arkode.hpp"
#include "../integrators/sundials/bdf2.hpp"
#include "../integrators/sundials/ida.hpp"
#include "../integrators/trapezoid.hpp"
#include "../lib/time/scheme.hpp"

namespace tact {
namespace {

/// The options that Ida and Arkode share.
template <class Options> Options step_control(NamedOptions& given) {
    Options options;
    if (const std::optional<double> rtol = given.number("rtol")) {
        options.rtol = *rtol;
        options.atol = *rtol / 1000;
    }
    options.atol = given.number("atol", options.atol);
    options.restitution = given.number("e");
    options.first_step = given.number("first_step", options.first_step);
    options.max_step = given.number("max_step", options.max_step);
    options.most_steps = given.whole("most_steps", options.most_steps);
    options.newton = given.flag("newton", options.newton);
    return options;
}

Shared<Integrator> ida(NamedOptions& given) {
    Ida::Options options = step_control<Ida::Options>(given);
    const long order = given.whole("order", options.max_order);
    if (order < std::numeric_limits<int>::min() || order > std::numeric_limits<int>::max())
        throw InputError("integrator ida: order is " + std::to_string(order) + ", expected from 1 to 5");
    options.max_order = static_cast<int>(order);
    return Ida(options);
}

Shared<Integrator> runge_kutta(ButcherTable table, NamedOptions& given) {
    for (const char* option : {"rtol", "atol", "first_step", "max_step", "most_steps", "newton"})
        if (given.has(option)) return Arkode(std::move(table), step_control<Arkode::Options>(given));
    // Asked for so that messages list them.
    for (const char* option : {"rtol", "atol", "first_step", "max_step", "most_steps", "newton"})
        (void)given.number(option);
    return Arkode(std::move(table), given.number("e"));
}

void add_integrators(Registry& all) {
    all.add_integrator("bdf2", [](NamedOptions&) { return Bdf2(); });
    all.add_integrator("bdf2-without-jump",
                       [](NamedOptions& given) { return Bdf2WithoutJump(given.number("e", 0)); });
    all.add_integrator("central-difference",
                       [](NamedOptions& given) { return CentralDifference(given.number("e", 0)); });
    all.add_integrator("moreau-jean", [](NamedOptions& given) {
        const double theta = given.number("theta", MoreauJean::Options{}.theta);
        return MoreauJean({theta, given.number("e", 0)});
    });
    all.add_integrator("quasi-static", [](NamedOptions&) { return QuasiStatic(); });
    all.add_integrator("trapezoid", [](NamedOptions& given) {
        const double rho = given.number("rho", Trapezoid::Options{}.rho);
        return Trapezoid({rho, given.number("e", 0)});
    });
    all.add_integrator("ida", ida);
    all.add_integrator("ida-fixed", [](NamedOptions&) { return Ida::fixed_step(); });
    all.add_integrator("sdirk2", [](NamedOptions& given) { return runge_kutta(sdirk2(), given); });
    all.add_integrator("tr-bdf2", [](NamedOptions& given) { return runge_kutta(tr_bdf2(), given); });
    all.add_integrator("esdirk32", [](NamedOptions& given) { return runge_kutta(esdirk32(), given); });
    all.add_integrator("sdirk54", [](NamedOptions& given) { return runge_kutta(sdirk54(), given); });
}

void add_contact_solvers(Registry& all) {
    all.add_contact("automatic", [](NamedOptions&) { return AutomaticContact(); });
    all.add_contact("colour-sor", [](NamedOptions&) { return ColourSor(); });
    all.add_contact("dense", [](NamedOptions& given) {
        DenseContactOptions options;
        options.compliance = given.number("compliance", options.compliance);
        options.screening = given.flag("screening", options.screening);
        return DenseContact(options);
    });
    all.add_contact("diagonal", [](NamedOptions&) { return DiagonalContact(); });
    all.add_contact("floating", [](NamedOptions&) { return FloatingContact(); });
    all.add_contact("interior-point", [](NamedOptions&) { return InteriorPoint(std::make_shared<SchurContact>()); });
    all.add_contact("klu-active-set", [](NamedOptions&) { return KluActiveSet(); });
    all.add_contact("multigrid", [](NamedOptions&) { return MultigridActiveSet(); });
    all.add_contact("orthogonal", [](NamedOptions&) { return OrthogonalContact(); });
    all.add_contact("principal-pivoting", [](NamedOptions&) { return PrincipalPivoting(); });
    all.add_contact("projected-cg", [](NamedOptions&) { return ProjectedCg(); });
    all.add_contact("refined", [](NamedOptions&) { return RefinedContact(std::make_shared<AutomaticContact>()); });
    all.add_contact("schur", [](NamedOptions&) { return SchurContact(); });
}

}  // namespace

const Registry& registry() {
    static const Registry all = [] {
        Registry made;
        add_integrators(made);
        add_contact_solvers(made);
        return made;
    }();
    return all;
}

Scheme Scheme::named(std::string_view integrator, const TimeGrid& grid, std::string_view contact) {
    return {registry().integrator(integrator), grid, registry().contact(contact)};
}

}  // namespace tact
