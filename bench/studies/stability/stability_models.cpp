#include "stability_models.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "../../../contact/automatic.hpp"
#include "../../../contact/dense/dense_contact.hpp"
#include "../../../integrators/central_difference.hpp"
#include "../../../lib/scenes/bar.hpp"
#include "../../../lib/scenes/mass_on_stop.hpp"
#include "../../../lib/scenes/membrane.hpp"
#include "../../../lib/scenes/plates.hpp"
#include "../../../lib/time/trajectory.hpp"
#include "../../../rom/bases/nnmf.hpp"
#include "../../../rom/bases/pod.hpp"
#include "../../../rom/bases/snapshots.hpp"
#include "../../../rom/error/relative_error.hpp"
#include "../../../rom/model/reduce.hpp"
#include "../../harness/interrupt.hpp"
#include "../../harness/measure.hpp"
#include "../../harness/methods.hpp"
#include "stability_row.hpp"

namespace tact::bench {
namespace {

std::vector<std::string> dynamic_integrators() {
    std::vector<std::string> names = stability_integrators();
    std::erase(names, "quasi-static");
    return names;
}

/// Nothing where the march failed, or an explicit method refused the step.
std::optional<State> final_state(const std::string& name, const ContactProblem& problem, const TimeGrid& grid) {
    throw_if_interrupted();
    ContactWorkspace workspace(std::make_shared<DenseContact>());
    const auto method = integrator(name);
    if (name.starts_with("central-difference") &&
        grid.dt > CentralDifference::largest_step(problem, workspace, grid.dt))
        return std::nullopt;
    MarchReport report = integrate(*method, problem, grid, workspace);
    if (report.outcome != Outcome::converged) return std::nullopt;
    return std::move(report.final_state);
}

Json mass_row(const std::string& name) {
    constexpr int phases = 40;
    constexpr double dt = 0.1;
    double least = infinity, most = -infinity;
    int failed = 0;
    for (int phase = 0; phase < phases; ++phase) {
        const double height = 1 + dt * phase / phases;
        const auto problem = mass_on_stop({.gravity = 0, .height = height, .velocity = -1}).problem;
        const auto state = final_state(name, problem, {dt, 60});
        if (!state) {
            ++failed;
            continue;
        }
        least = std::min(least, state->v()[0]);
        most = std::max(most, state->v()[0]);
    }
    Json row{{"scene", "mass"}, {"integrator", name}, {"dt", dt}, {"e_min", nullptr}, {"e_max", nullptr}};
    if (failed < phases) row.update({{"e_min", least}, {"e_max", most}});
    row["failed"] = failed;
    return row;
}

Json bar_row(const std::string& name, Index elements, double dt) {
    const ContactProblem problem = bar_impact(elements).problem;
    const Vector mass = problem.M->main_diagonal();
    const auto state = final_state(name, problem, {dt, std::lround(1.5 / dt)});
    const Json e = state ? Json(mass.dot(state->v()) / (10 * mass.sum())) : Json();
    return {{"scene", "bar"}, {"integrator", name}, {"dt", dt},
            {"e_min", e},     {"e_max", e},         {"failed", state ? 0 : 1}};
}

constexpr double membrane_dt = 0.005, membrane_end = 2;

/// u at every multiple of the coarse step.
Trajectory membrane_motion(const std::string& name, const ContactProblem& problem, long refinement) {
    const TimeGrid grid{membrane_dt / static_cast<double>(refinement),
                        std::lround(membrane_end / membrane_dt) * refinement};
    Trajectory motion(problem, grid.steps, {.stride = refinement, .initial = true, .multipliers = false});
    ContactWorkspace workspace(std::make_shared<AutomaticContact>());
    const std::vector<Observer> observers{motion.observer()};
    (void)run("membrane, " + name, problem, {integrator(name), grid}, workspace, observers);
    return motion;
}

double distance_percent(const Trajectory& a, const Trajectory& b) {
    return 100 * (a.u() - b.u()).squaredNorm() / b.u().squaredNorm();
}

/// What the reduced models of one integrator are made of and compared with.
struct FullPlates {
    Trajectory motion;
    DenseMatrix modes;
    DualSnapshots dual;
};

FullPlates full_plates(const ContactProblem& problem, const Scheme& scheme, Index largest) {
    FullPlates full{Trajectory(problem, scheme.grid.steps, {.stride = 1, .initial = true, .multipliers = false}),
                    {},
                    DualSnapshots(problem.constraints())};
    ContactWorkspace workspace(std::make_shared<AutomaticContact>());
    const std::vector<Observer> observers{full.motion.observer(), [&](const State& state, const StepReport&) {
                                              full.dual.add(state.lambda);
                                              return Flow::proceed;
                                          }};
    (void)run("two-plates, full", problem, scheme, workspace, observers);
    full.modes = pod(full.motion.u(), {.rank = largest}).modes;
    return full;
}

ReducedBasis plates_basis(const ContactProblem& problem, const FullPlates& full, Index p) {
    return modal_basis(problem, {full.modes.leftCols(p), nnmf(full.dual.matrix(), p).U_lambda});
}

Trajectory reduced_motion(const ContactProblem& reduced, const Scheme& scheme) {
    Trajectory motion(reduced, scheme.grid.steps, {.stride = 1, .initial = true, .multipliers = false});
    ContactWorkspace workspace(std::make_shared<DenseContact>());
    const std::vector<Observer> observers{motion.observer()};
    (void)run("two-plates, reduced", reduced, scheme, workspace, observers);
    return motion;
}

/// Eq. 17 between the motions at a gap and at one larger by 1e-6 of itself: the modes are orthonormal in the plates' mass,
/// which is one number times the identity.
double gap_sensitivity(ContactProblem reduced, const Scheme& scheme) {
    const Trajectory at = reduced_motion(reduced, scheme);
    reduced.c.modes *= 1 + 1e-6;
    return distance_percent(reduced_motion(reduced, scheme), at);
}

double geometric_mean(const std::vector<double>& values) {
    double sum = 0;
    for (const double value : values) sum += std::log(value);
    return std::exp(sum / static_cast<double>(values.size()));
}

}  // namespace

Json restitution_rows(bool small) {
    const std::vector<std::string> names = dynamic_integrators();
    const std::vector<double> steps = small ? std::vector{0.02, 0.005} : std::vector{0.02, 0.005, 0.00125, 0.0003125};
    Progress progress("restitution", static_cast<double>(names.size() * (steps.size() + 1)));
    Json rows = Json::array();
    for (const std::string& name : names) {
        rows.push_back(mass_row(name));
        progress.add(1);
        for (const double dt : steps) {
            if (dt == steps.front() || !integrator(name)->adaptive())
                rows.push_back(bar_row(name, small ? 10 : 40, dt));
            progress.add(1);
        }
    }
    return rows;
}

Json membrane_rows(bool small) {
    const ContactProblem problem = MembraneFamily(small ? 8 : 20, Motion::dynamic).at(Eigen::Vector2d(0.6, 0.6));
    const std::vector<long> refinements = small ? std::vector<long>{1, 4} : std::vector<long>{1, 4, 16};
    std::vector<std::string> names = dynamic_integrators();
    std::erase_if(names, [](const std::string& name) { return integrator(name)->adaptive(); });
    const std::vector<std::string> laws{"0", "0.2", "0.4", "0.6", "0.8", "1"};
    Progress progress("membrane", static_cast<double>(laws.size() + names.size() * refinements.size()));
    std::vector<Trajectory> references;
    for (const std::string& e : laws) {
        references.push_back(membrane_motion("trapezoid:e=" + e, problem, 2 * refinements.back()));
        progress.add(1);
    }
    Json rows = Json::array();
    for (const std::string& name : names)
        for (const long refinement : refinements) {
            const Trajectory motion = membrane_motion(name, problem, refinement);
            Json row{{"integrator", name}, {"dt", membrane_dt / static_cast<double>(refinement)}};
            std::size_t nearest = 0;
            std::vector<double> distances;
            Json all = Json::array();
            for (std::size_t k = 0; k < laws.size(); ++k) {
                distances.push_back(distance_percent(motion, references[k]));
                all.push_back({{"e", std::stod(laws[k])}, {"percent", distances[k]}});
                if (distances[k] < distances[nearest]) nearest = k;
            }
            row["nearest_e"] = std::stod(laws[nearest]);
            row["distance_percent"] = distances[nearest];
            row["distances"] = std::move(all);
            rows.push_back(std::move(row));
            progress.add(1);
        }
    return rows;
}

Json reduced_plates(bool small) {
    const ContactProblem problem = two_plates(small ? 16 : 100).problem;
    const TimeGrid grid = TimeGrid::until(small ? 0.1 : 0.4, 2e-4);
    std::vector<Index> sizes;
    for (Index p = small ? 19 : 36; p <= (small ? 21 : 44); ++p) sizes.push_back(p);
    const Index middle = sizes[sizes.size() / 2];
    const std::vector<std::string> names{"bdf2", "trapezoid", "bdf2-without-jump"};
    Progress progress("reduced plates", static_cast<double>(names.size() * (sizes.size() + 2)));
    Json json{{"gap_sensitivity", Json::array()}, {"reduced_error", Json::array()}};
    double bdf2 = 0;
    for (const std::string& name : names) {
        const Scheme scheme{integrator(name), grid};
        const FullPlates full = full_plates(problem, scheme, sizes.back());
        progress.add(2);
        std::vector<double> errors;
        for (const Index p : sizes) {
            const ReducedBasis basis = plates_basis(problem, full, p);
            const ContactProblem reduced = reduce(problem, basis);
            errors.push_back(
                relative_error(problem, full.motion, basis, reduced_motion(reduced, scheme)).squared_percent);
            if (p == middle)
                json["gap_sensitivity"].push_back(
                    {{"integrator", name}, {"p", p}, {"change_percent", gap_sensitivity(reduced, scheme)}});
            progress.add(1);
        }
        const double mean = geometric_mean(errors);
        if (name == "bdf2") bdf2 = mean;
        json["reduced_error"].push_back({{"integrator", name},
                                         {"p", sizes},
                                         {"percent", errors},
                                         {"geometric_mean_percent", mean},
                                         {"over_bdf2", mean / bdf2}});
    }
    return json;
}

}  // namespace tact::bench
