#include "solvers.hpp"

#include <algorithm>
#include <cmath>

#include "../../harness/growth.hpp"
#include "../../peers/interior_point.hpp"
#include "../../peers/peer_program.hpp"
#include "../../peers/petsc_peer.hpp"
#include "solver_timing.hpp"

namespace tact::bench {
namespace {

const std::vector<std::string> scene_names{"static-obstacle", "dynamic-obstacle", "two-plates"};

/// Dense strategies are for reduced problems: these matrices would not fit in memory as dense ones.
bool is_dense(const NamedSolver& solver) { return solver.name == "dense" || solver.name == "orthogonal"; }

void add(Json& rows, Json row) {
    if (!row.is_null()) rows.push_back(std::move(row));
}

Json describe(const SolverProblem& problem) {
    const SampledSolve& first = problem.samples.front();
    return {{"problem", problem.name},
            {"what", problem.what},
            {"unknowns", first.A.rows()},
            {"constraints", first.B.rows()},
            {"entries", first.A.to_sparse().nonZeros()},
            {"samples", problem.samples.size()},
            {"reference_kkt_residual", problem.reference_kkt},
            {"reference_agreement", problem.reference_agreement}};
}

/// The chooser on both numberings.
Json numbering_of(const SolverProblem& problem, const Json& rows, const TimingOptions& options) {
    const NamedSolver& chooser = contact_solvers().front();
    Json result{{"problem", problem.name}, {"solver", chooser.name}};
    const Json other = time_solver(permuted(problem), chooser, options);
    for (const Json& row : rows)
        if (row["problem"] == problem.name && row["solver"] == chooser.name)
            result["seconds"] = row["seconds_median"];
    result["permuted_seconds"] = other["seconds_median"];
    result["permuted_solution_error"] = other["solution_error"];
    const bool both = result["seconds"].is_number() && other["seconds_median"].is_number();
    result["ratio"] = both ? Json(other["seconds_median"].get<double>() / result["seconds"].get<double>()) : Json();
    return result;
}

/// A peer that takes hundreds of times as long as the chooser has lost: nothing is learnt from waiting for it.
double peer_solve_limit(const Json& rows, const std::string& problem, bool small) {
    constexpr double lost = 500, most = 60;
    const double least = small ? 1 : 10;
    for (const Json& row : rows)
        if (row["problem"] == problem && row["solver"] == "chooser" && row["seconds_median"].is_number())
            return std::clamp(std::ceil(lost * row["seconds_median"].get<double>()), least, most);
    return most;
}

void measure_scene(Json& json, const std::string& scene, const SolversOptions& options,
                   const std::optional<std::string>& petsc) {
    const bool plates = scene == "two-plates";
    const Index side = options.side > 0 ? options.side : !options.small ? 0 : plates ? 40 : 60;
    TimingOptions timing;
    timing.repeats = options.repeats;
    if (options.small) timing.enough = 1;
    for (const SolverProblem& problem : solver_problems(scene, side)) {
        json["problems"].push_back(describe(problem));
        const auto count = contact_solvers().size() + (petsc ? petsc_methods().size() : 0) + 1;
        Progress progress(problem.name, static_cast<double>(count));
        for (const NamedSolver& solver : contact_solvers()) {
            if (!is_dense(solver) && (!solver.peer || options.peers))
                add(json["rows"], time_solver(problem, solver, timing));
            progress.add(1);
        }
        timing.peer_solve = peer_solve_limit(json["rows"], problem.name, options.small);
        if (petsc)
            for (const PetscMethod& method : petsc_methods()) {
                add(json["rows"], time_petsc(problem, method, *petsc, timing));
                progress.add(1);
            }
        json["numbering"].push_back(numbering_of(problem, json["rows"], timing));
        progress.add(1);
    }
}

std::vector<GrowthOptions> growth_of(const SolversOptions& options) {
    std::vector<GrowthOptions> all{{.scene = "dynamic-obstacle"}, {.scene = "two-plates"}};
    all[0].sides =
        options.small ? std::vector<Index>{25, 50, 100, 200} : std::vector<Index>{50, 100, 200, 400, 700, 1000};
    all[1].sides = options.small ? std::vector<Index>{12, 25, 50} : std::vector<Index>{25, 50, 100, 200};
    if (options.growth.size() == 2)
        for (std::size_t k = 0; k < 2; ++k) all[k].sides = options.growth[k];
    // A part of the march with contact and without, the same physical time at every size.
    all[0].t_end = 0.75;
    all[1].t_end = 0.08;
    const double limit = options.small ? 20 : 240;
    for (GrowthOptions& each : all) each.limit = limit;
    return all;
}

}  // namespace

Json run_solvers(const SolversOptions& options) {
    if (options.repeats < 1)
        throw InputError("solvers: repeats is " + std::to_string(options.repeats) + ", expected at least 1");
    for (const std::string& name : options.scenes)
        if (std::ranges::find(scene_names, name) == scene_names.end())
            throw InputError("solvers: scene is " + name +
                             ", expected static-obstacle, dynamic-obstacle or two-plates");
    const std::optional<std::string> petsc = options.peers ? petsc_program() : std::nullopt;
    Json json;
    json["study"] = "solvers";
    json["size"] = options.small ? "small" : "full";
    json["repeats"] = options.repeats;
    json["machine"] = machine();
    json["peers"] = Json::object();
    if (options.peers) {
        json["peers"]["IPOPT"] = interior_point() ? Json(interior_point_version()) : Json();
        json["peers"]["PETSc"] = petsc ? Json(peer_version(*petsc)) : Json();
    }
    for (const char* list : {"problems", "rows", "numbering", "growth"}) json[list] = Json::array();
    const auto wanted = [&](const std::string& name) {
        return options.scenes.empty() || std::ranges::find(options.scenes, name) != options.scenes.end();
    };
    for (const std::string& name : scene_names)
        if (wanted(name)) measure_scene(json, name, options, petsc);
    for (const GrowthOptions& growth : growth_of(options))
        if (wanted(growth.scene)) json["growth"].push_back(run_growth(growth));
    return json;
}

std::string missing_peers(const Json& json) {
    std::string text;
    for (const auto& [name, version] : json["peers"].items())
        if (version.is_null()) text += (text.empty() ? "" : ", ") + name;
    if (!text.empty()) text += ": not found when this was built; compared with the other peers only";
    return text;
}

}  // namespace tact::bench
