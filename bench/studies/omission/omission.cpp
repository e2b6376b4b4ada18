#include "omission.hpp"

#include <algorithm>
#include <cmath>

#include "../../../contact/automatic.hpp"
#include "../../../integrators/sundials/bdf2.hpp"
#include "../../../lib/errors.hpp"
#include "../../../lib/scenes/membrane.hpp"
#include "../../../lib/sparse/cholmod_solver.hpp"
#include "../../harness/interrupt.hpp"
#include "../../harness/linked_libraries.hpp"
#include "../../harness/measure.hpp"
#include "../../harness/report.hpp"
#include "../../harness/timing.hpp"

namespace tact::bench {
namespace {

/// One run of a scene: what it came to.
struct Seen {
    std::string strategy;
    Index most_active = 0;
    long first_contact = 0;
};

Seen look(const StudyScene& scene, const ContactProblem& problem) {
    ContactWorkspace workspace(std::make_shared<AutomaticContact>());
    const Scheme scheme = paper_scheme(scene);
    Seen seen;
    if (!scheme.integrator) {
        const RunSummary summary = run(scene.name, problem, scheme, workspace);
        return {summary.strategy, summary.most_active, 0};
    }
    Progress progress("omission: " + scene.name, static_cast<double>(scheme.grid.steps));
    const std::vector<Observer> watch{[&](const State& state, const StepReport& report) {
        progress.at(static_cast<double>(state.step));
        if (state.step > 0) seen.strategy = report.contact.strategy;
        if (report.contact.active > 0 && seen.first_contact == 0) seen.first_contact = state.step;
        seen.most_active = std::max(seen.most_active, report.contact.active);
        return Flow::proceed;
    }};
    (void)run(scene.name, problem, scheme, workspace, watch);
    return seen;
}

void add_parts(Json& rows, const StudyScene& scene) {
    const ContactFamily& family = *scene.family;
    const ContactProblem problem = family.at(0.5 * (family.lower() + family.upper()));
    const Seen seen = look(scene, problem);
    const auto put = [&](const char* part, bool used, const std::string& why) {
        rows.push_back({{"scene", scene.name}, {"part", part}, {"used", used}, {"why", why}});
    };
    const bool touches = seen.most_active > 0;
    const auto number = [](auto n) { return std::to_string(n); };
    put("M", problem.M.has_value(), problem.M ? "second order in time" : "no inertia");
    put("D", problem.D.has_value(), problem.D ? "damping, or first order in time" : "no damping");
    put("r(u)", problem.r.has_value(), problem.r ? "internal forces that are not linear" : "K is all there is");
    put("time integrator", !scene.is_static(), scene.is_static() ? "one solve" : "steps in time");
    put("contact rows", problem.constraints() > 0, number(problem.constraints()) + " rows in B");
    std::string why = "the gap never closes";
    if (touches)
        why = scene.is_static()
                  ? number(seen.most_active) + " rows in contact"
                  : "from step " + number(seen.first_contact) + " on, at most " + number(seen.most_active) + " rows";
    put("active set", touches, why);
    const bool factor =
        seen.strategy.find("Schur") != std::string::npos || seen.strategy.find("KLU") != std::string::npos;
    put("sparse factor (CHOLMOD, KLU)", factor, "contact by " + seen.strategy);
    put("dual basis, if reduced", touches, touches ? "multipliers to represent" : "no multipliers");
    put("gap interpolation, if reduced", !family.names().empty(),
        family.names().empty() ? "the gap has no parameter"
                               : "the gap depends on " + number(family.names().size()) + " parameters");
    const bool hooked = !problem.is_static();
    put("SUNDIALS", hooked,
        hooked              ? "its vectors and nonlinear solver drive the step"
        : scene.is_static() ? "no steps in time"
                            : "steps without a time derivative");
    put("lift of U q", false, "only where a field is asked for");
    put("GSL", false, "samples parameters in training, nothing online");
    put("HDF5", false, "reads and writes model files only");
}

ContactProblem without_contact(const ContactProblem& problem) {
    ContactProblem free = problem;
    free.B = Matrix(SparseMatrix(0, problem.size()));
    free.c = AffineVector(Vector(0));
    return free;
}

/// BDF2 by hand: one factor, five vectors, no certificate, no report.
Vector bare_march(const ContactProblem& p, const TimeGrid& grid) {
    const double dt = grid.dt, a = 1.5 / dt;
    const Vector f = p.f.at(0), mass = *p.M->diagonal_entries();
    const auto first = CholmodSolver().factorize(combine(1, p.K, 1 / (dt * dt), *p.M));
    const auto factor = CholmodSolver().factorize(combine(1, p.K, a * a, *p.M));
    Vector u = p.u0, v = p.v0, u_before = u, v_before = v, b_u, next;
    for (long step = 1; step <= grid.steps; ++step) {
        if (step == 1) {
            b_u = -u / dt;
            next = f - mass.cwiseProduct(-v / dt + b_u / dt);
            first->solve(next);
        } else {
            b_u = (0.5 * u_before - 2 * u) / dt;
            next = f - mass.cwiseProduct((0.5 * v_before - 2 * v) / dt + a * b_u);
            factor->solve(next);
        }
        u_before.swap(u);
        u.swap(next);
        v_before.swap(v);
        v = (step == 1 ? 1 / dt : a) * u + b_u;
    }
    return u;
}

struct Timed {
    double first, second;
};
/// Both in turn, so that a change of the machine's speed meets both; the least of each.
template <class First, class Second> Timed in_turn(int repeats, First&& first, Second&& second) {
    Timed least{infinity, infinity};
    for (int k = 0; k < repeats; ++k) {
        throw_if_interrupted();
        least.first = std::min(least.first, seconds_of(first));
        least.second = std::min(least.second, seconds_of(second));
    }
    return least;
}

Json cost(const std::string& what, const std::string& baseline, const Timed& times, double asked) {
    const double over = 100 * (times.second / times.first - 1);
    return {{"what", what},
            {"baseline", baseline},
            {"seconds_baseline", times.first},
            {"seconds", times.second},
            {"over_percent", over},
            {"asked_percent", asked},
            {"said", digits(std::abs(over), 2) + (over < 0 ? " % less than " : " % over ") + baseline}};
}

Json costs(bool small) {
    const Index n = small ? 60 : 200;
    const int repeats = small ? 3 : 5;
    const TimeGrid grid = TimeGrid::until(small ? 0.5 : 1.0, 0.005);
    const ContactProblem membrane = MembraneFamily(n, Motion::dynamic).at(Eigen::Vector2d(0.45, 0.4));
    const ContactProblem free = without_contact(membrane);
    const auto march = [&grid](const ContactProblem& problem, Vector& u) {
        ContactWorkspace workspace(std::make_shared<AutomaticContact>());
        MarchReport report = integrate(Bdf2(), problem, grid, workspace);
        if (report.outcome != Outcome::converged) throw NumericalError("omission: a march did not converge");
        u = report.final_state.u();
    };
    Json rows = Json::array();
    Vector bare, ours;
    Timed times = in_turn(
        repeats, [&] { bare = bare_march(free, grid); }, [&] { march(free, ours); });
    if (!((bare - ours).norm() <= 1e-9 * bare.norm()))
        throw NumericalError("omission: the march without contact differs from the one by hand");
    rows.push_back(
        cost("a scene without contact, each step certified", "the same march by hand, uncertified", times, 2));

    ContactProblem far = membrane;
    far.c = AffineVector(Vector(Vector::Constant(membrane.constraints(), -1e3)));
    Vector touching_nothing;
    times = in_turn(
        repeats, [&] { march(free, ours); }, [&] { march(far, touching_nothing); });
    rows.push_back(cost("a scene whose gap never closes", "the scene without rows", times, 5));

    const ContactProblem obstacle = MembraneFamily(n).at(Eigen::Vector2d(0.45, 0.4));
    Vector solution;
    times = in_turn(
        repeats,
        [&] {
            Vector u = Vector::Zero(obstacle.size()), lambda = Vector::Zero(obstacle.constraints());
            const auto prepared = AutomaticContact().prepare(obstacle.K, obstacle.B);
            if (prepared->solve(obstacle.f.at(0), obstacle.c.at(0), {u, lambda}).outcome != Outcome::converged)
                throw NumericalError("omission: the static solve did not converge");
        },
        [&] {
            ContactWorkspace workspace(std::make_shared<AutomaticContact>());
            solution = solve_static(obstacle, workspace).u;
        });
    rows.push_back(cost("a static scene", "its one contact solve", times, 2));
    return rows;
}

}  // namespace

Json run_omission(const StudyOptions& options) {
    check_scenes("omission", options, study_scene_names());
    Json json{{"study", "omission"}, {"size", options.small ? "small" : "full"}, {"machine", machine()}};
    json["rows"] = Json::array();
    for (const std::string& name : study_scene_names()) {
        if (!options.wants(name)) continue;
        StudyScene scene = study_scene(name);
        if (options.small && scene.family->at(scene.family->lower()).size() > 1000) scene = study_scene(name, 20);
        add_parts(json["rows"], scene);
    }
    json["costs"] = costs(options.small);
    json["programs"] = Json::array();
    const auto add = [&](const char* program, const char* does, const char* components) {
        json["programs"].push_back(online_program(program, does, components));
    };
    add("tact-online-static", "one static contact problem of any size", "core contact");
    add("tact-online-reduced", "static queries to a reduced model in memory", "core contact_dense rom");
    add("tact-online-march", "reduced marches in memory", "core contact_dense rom integrators");
    return json;
}

}  // namespace tact::bench
