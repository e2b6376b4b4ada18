#include "case.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <iostream>
#include <limits>
#include <map>
#include <utility>

#include "../../contact/automatic.hpp"
#include "../../lib/io/write_file.hpp"
#include "../../lib/time/energy.hpp"
#include "../harness/interrupt.hpp"
#include "../harness/methods.hpp"
#include "../harness/progress.hpp"
#include "../harness/scenes.hpp"
#include "../harness/timing.hpp"

namespace tact::bench {
namespace {

Json kkt_json(const KktResiduals& kkt) {
    return {{"stationarity", kkt.stationarity},
            {"penetration", kkt.penetration},
            {"negativity", kkt.negativity},
            {"complementarity", kkt.complementarity},
            {"largest", kkt.largest()}};
}

Json points_on_line_json(const CaseOptions& options, const Mesh& mesh, const Vector& u) {
    Json points = Json::array();
    for (const auto& [x, y] : options.points) {
        if (!std::isnan(y))
            throw InputError("case: point is (" + shown(x) + ", " + shown(y) +
                             "), expected one coordinate: the scene lies on the line");
        const std::size_t found = points.size();
        for (std::size_t body = 0; body < mesh.bodies.size(); ++body)
            if (x >= mesh.bodies[body].left && x <= mesh.bodies[body].right)
                points.push_back({{"x", x}, {"body", body}, {"u", value_on_line(mesh, u, x, body)}});
        if (points.size() == found)
            throw InputError("case: point is " + shown(x) + ", expected one of a body of the scene");
    }
    return points;
}

Json points_json(const CaseOptions& options, const Mesh& mesh, const Vector& u) {
    if (!mesh.square()) return points_on_line_json(options, mesh, u);
    Json points = Json::array();
    for (const auto& [x, y] : options.points) {
        Json point = {{"x", x}, {"y", y}};
        if (mesh.bodies.size() == 1) {
            point["u"] = value_at(mesh, u, x, y);
        } else {
            point["lower"] = value_at(mesh, u, x, y, 0);
            point["upper"] = value_at(mesh, u, x, y, 1);
        }
        points.push_back(std::move(point));
    }
    return points;
}

Json error_json(const ExactState& exact, const State& state) {
    return {{"u", (exact.u - state.u()).cwiseAbs().maxCoeff()},
            {"v", std::sqrt((exact.v - state.v()).squaredNorm() / static_cast<double>(state.n))},
            {"contact_force", exact.lambda.sum() - state.lambda.sum()}};
}

Json state_json(const CaseOptions& options, const StudyScene& scene, const ContactProblem& problem,
                const State& state, Index active) {
    const Energy energy = energy_of(problem, state);
    const Vector u = state.u();
    Json json;
    if (!scene.is_static()) {
        json["t"] = state.t;
        json["step"] = state.step;
    }
    json["active"] = active;
    if (problem.K.is_symmetric())  // else there is none
        json["energy"] = {{"kinetic", energy.kinetic},
                          {"strain", energy.strain},
                          {"potential", energy.potential},
                          {"total", energy.total()}};
    json["min_u"] = u.minCoeff();
    json["max_u"] = u.maxCoeff();
    json["contact_force"] = state.lambda.sum();
    json["points"] = points_json(options, scene.mesh, u);
    if (scene.exact) json["error"] = error_json(scene.exact(state.t), state);
    return json;
}

/// Steps of the grid, in the order of `times`.
std::vector<long> steps_at(const std::vector<double>& times, const TimeGrid& grid) {
    std::vector<long> steps;
    for (const double t : times) {
        const double step = (t - grid.t0) / grid.dt;
        if (!(step >= -1e-6 && step <= static_cast<double>(grid.steps) + 1e-6) ||
            std::abs(step - std::round(step)) > 1e-6)
            throw InputError("case: at is " + shown(t) + ", expected a whole number of steps of dt = " +
                             shown(grid.dt) + " up to t_end = " + shown(grid.t(grid.steps)));
        steps.push_back(std::lround(step));
    }
    return steps;
}

/// One equilibrium, or those at the times asked for where load or gap move.
void run_static(const CaseOptions& options, const StudyScene& scene, const ContactProblem& problem, Json& json) {
    ContactWorkspace workspace(options.contact);
    StageSolver stages(problem, workspace);
    State state(problem);
    const Vector zero = Vector::Zero(problem.size());
    ContactReport report;
    int iterations = 0;
    Index most_active = 0;
    json["states"] = Json::array();
    const double seconds = seconds_of([&] {
        for (const double t : options.at.empty() ? std::vector{0.0} : options.at) {
            report = stages.solve(Stage{t, 0, zero, zero}, state);
            iterations += report.iterations;
            if (report.outcome != Outcome::converged) break;
            most_active = std::max(most_active, report.active);
            json["states"].push_back(state_json(options, scene, problem, state, report.active));
            if (!options.at.empty()) json["states"].back()["t"] = t;
        }
    });
    json["outcome"] = to_string(report.outcome);
    json["seconds"] = seconds;
    json["strategy"] = report.strategy;
    json["contact_iterations"] = iterations;
    json["most_active"] = most_active;
    json["kkt"] = kkt_json(report.kkt);
    if (report.outcome != Outcome::converged) json["failed_step"] = json["states"].size() + 1;
}

const char* usual_integrator(const ContactProblem& problem) { return problem.is_static() ? "quasi-static" : "bdf2"; }

void run_march(const CaseOptions& options, const StudyScene& scene, const ContactProblem& problem, Json& json) {
    const TimeGrid grid = TimeGrid::until(options.t_end.value_or(scene.t_end), options.dt.value_or(scene.dt));
    const auto method = integrator(options.integrator.empty() ? usual_integrator(problem) : options.integrator);
    std::vector<double> times = options.at.empty() ? std::vector{grid.t(grid.steps)} : options.at;
    if (!method->adaptive()) {
        const std::vector<long> steps = steps_at(times, grid);
        std::ranges::transform(steps, times.begin(), [&](long step) { return grid.t(step); });
    }
    const std::vector<double> asked = times;
    std::ranges::sort(times);
    times.erase(std::ranges::unique(times).begin(), times.end());
    json["integrator"] = method->name();
    json["dt"] = grid.dt;
    json["t_end"] = grid.t(grid.steps);
    json["steps"] = grid.steps;

    std::map<double, Json> states;
    Progress progress(scene.name, grid.t(grid.steps) - grid.t0);
    double impulse = 0, before = grid.t0;
    long intervals = 0;
    bool touching = false;
    const auto watch = [&](const State& state, const StepReport&) {
        impulse += (state.t - before) * state.lambda.sum();
        before = state.t;
        const bool touched = std::exchange(touching, (state.lambda.array() > 0).any());
        intervals += touching && !touched;
        progress.at(state.t - grid.t0);
        return Flow::proceed;
    };
    ContactWorkspace workspace(options.contact);
    const std::vector<Observer> observers{watch};
    MarchReport march;
    const double seconds = seconds_of([&] {
        march = integrate_with_output(
            *method, problem, grid, workspace, times,
            [&](const State& state) {
                const Index active = (state.lambda.array() > 0).count();
                states[state.t] = state_json(options, scene, problem, state, active);
            },
            observers);
    });
    json["outcome"] = to_string(march.outcome);
    json["seconds"] = seconds;
    json["strategy"] = march.last.contact.strategy;
    json["accepted_steps"] = march.accepted_steps;
    json["first_contact_step"] = march.first_contact_step;
    json["contact_intervals"] = intervals;
    json["impulse"] = impulse;
    json["most_active"] = march.most_active;
    json["contact_iterations"] = march.contact_iterations;
    json["kkt"] = kkt_json(march.worst_kkt);
    if (march.outcome != Outcome::converged) json["failed_step"] = march.last.step;
    json["states"] = Json::array();
    for (const double t : asked)
        if (states.contains(t)) json["states"].push_back(states[t]);
}

void check(const CaseOptions& options, const StudyScene& scene) {
    const std::size_t parameters = scene.family->names().size();
    if (options.gamma.size() != parameters)
        throw InputError("case: gamma has " + std::to_string(options.gamma.size()) + " numbers, expected " +
                         std::to_string(parameters) + " for " + scene.name);
    if (options.n < 0) throw InputError("case: n is " + std::to_string(options.n) + ", expected zero or more");
    if (scene.is_static() && (options.dt || options.t_end))
        throw InputError("case: dt or t_end is given, expected neither for " + scene.name);
}

}  // namespace

Json run_case(const CaseOptions& given) {
    CaseOptions options = given;
    if (!options.contact) options.contact = std::make_shared<AutomaticContact>();
    const StudyScene scene = study_scene(options.scene, options.n);
    if (options.points.empty() && scene.mesh.square()) options.points = {{0.5, 0.5}};
    check(options, scene);
    const ContactProblem problem =
        scene.family->at(Eigen::Map<const Vector>(options.gamma.data(), static_cast<Index>(options.gamma.size())));
    if (!options.at.empty() && scene.is_static() && problem.f.constant() && problem.c.constant())
        throw InputError("case: at is given, expected no times for " + scene.name);
    points_json(options, scene.mesh, Vector::Zero(problem.size()));  // a bad point is said before the run, not after

    Json json;
    json["scene"] = scene.name;
    json["n"] = scene.n;
    json["unknowns"] = problem.size();
    json["contact_constraints"] = problem.constraints();
    json["gamma"] = options.gamma;
    const bool equilibria = options.integrator.empty() && !options.dt && !options.t_end && problem.is_static();
    if (scene.is_static() || equilibria)
        run_static(options, scene, problem, json);
    else
        run_march(options, scene, problem, json);
    if (json.contains("failed_step"))
        json["message"] = "step " + json["failed_step"].dump() + ": the contact solve ended with " +
                          json["outcome"].get<std::string>();
    return json;
}

std::vector<std::array<double, 2>> parse_points(const std::string& text) {
    const auto reject = [&text]() -> std::vector<std::array<double, 2>> {
        throw InputError("case: points is \"" + text + "\", expected X1,Y1;X2,Y2;...");
    };
    std::vector<std::array<double, 2>> points;
    const char* next = text.data();
    const char* const end = next + text.size();
    while (next != end) {
        std::array<double, 2> point{0, std::numeric_limits<double>::quiet_NaN()};
        for (double& coordinate : point) {
            const auto [after, error] = std::from_chars(next, end, coordinate);
            if (error != std::errc()) return reject();
            next = after;
            if (&coordinate == &point[1] || next == end || *next != ',') break;
            ++next;
        }
        points.push_back(point);
        if (next != end && *next++ != ';') return reject();
    }
    return points;
}

namespace {

std::function<int()> declare(CLI::App& command) {
    struct Arguments {
        CaseOptions options;
        std::string points, out;
    };
    const auto arguments = std::make_shared<Arguments>();
    CaseOptions& options = arguments->options;
    std::string scenes;
    for (const std::string& name : study_scene_names()) scenes += (scenes.empty() ? "" : ", ") + name;
    command.add_option("scene", options.scene, scenes)->required();
    command.add_option("--n", options.n, "Nodes a side or elements (the paper's 200, plates 100; else as usual)");
    command.add_option("--gamma", options.gamma, "Parameters of the obstacle: G1,G2")->delimiter(',');
    command.add_option("--dt", options.dt, "Time step (the paper's: .005, plates 2e-4; else the usual)");
    command.add_option("--t-end", options.t_end, "End time (the paper's: 2, plates .4; else the usual)");
    command.add_option(
        "--integrator", options.integrator,
        "bdf2, bdf2-without-jump, central-difference, trapezoid, moreau-jean, ida, ida-fixed, sdirk2, tr-bdf2, "
        "esdirk32, "
        "sdirk54, quasi-static; options after a colon: trapezoid:rho=0.3,e=0, ida:rtol=1e-5 (bdf2; without M "
        "and D the equilibria at the times asked for)");
    command.add_option("--at", options.at, "Times to report: T1,T2,... (the end)")->delimiter(',');
    command.add_option("--points", arguments->points,
                       "Points to report: X1,Y1;X2,Y2;... (the centre); on the line X1;X2;...");
    command.add_option("--out", arguments->out, "json file (standard output)");
    return [arguments] {
        arguments->options.points = parse_points(arguments->points);
        const Json json = run_case(arguments->options);
        const std::string text = json.dump(2) + "\n";
        if (arguments->out.empty())
            std::cout << text;
        else
            write_file(arguments->out, text);
        if (!json.contains("message")) return 0;
        std::cerr << "tact-bench: " << json["message"].get<std::string>() << "\n";
        return 1;
    };
}

}  // namespace

Command case_command() {
    return {"case", "One full run: values at points and times, energies, KKT residuals", declare};
}

}  // namespace tact::bench
