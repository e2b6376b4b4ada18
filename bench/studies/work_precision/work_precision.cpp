#include "work_precision.hpp"

#include <algorithm>

#include <gsl/gsl_version.h>

#include "../../../lib/errors.hpp"
#include "../../harness/progress.hpp"
#include "../../harness/report.hpp"
#include "../../harness/timing.hpp"
#include "../../peers/peer_program.hpp"
#include "../../peers/siconos_peer.hpp"
#include "work_precision_answers.hpp"
#include "work_precision_gsl.hpp"
#include "work_precision_run.hpp"

namespace tact::bench {
namespace {

PrecisionTiming timing_of(const WorkPrecisionOptions& options) {
    return {options.repeats, options.small ? 0.01 : 0.25, options.small ? 0.12 : 4.0};
}

/// GSL's msbdf with the dense Jacobian, and its two methods that need none and suit a problem that is not stiff.
void add_gsl(Json& json, const PrecisionScene& scene, const PrecisionTiming& timing, Progress& progress) {
    const auto reference = scene.reference(precision_methods().front());
    std::vector<double> times;
    for (long k = 1; k <= scene.outputs; ++k) times.push_back(scene.output(k));
    for (const std::string method : {"msbdf", "msadams", "rk8pd"}) {
        const OrdinaryProblem problem = ordinary(scene.problem, method == "msbdf");
        for (const double tolerance : scene.tolerances) {
            Json row = empty_precision_row(scene, "GSL " + method, "rtol=" + digits(tolerance));
            OrdinaryRun run;
            std::vector<double> seconds;
            double spent = 0;
            while (static_cast<int>(seconds.size()) < timing.repeats && (seconds.empty() || spent < timing.enough)) {
                seconds.push_back(seconds_of([&] {
                    run = solve_ordinary(method, problem, times, tolerance, 1e-3 * tolerance, timing.limit);
                }));
                spent += seconds.back();
            }
            if (run.failure.empty()) {
                row["steps"] = run.steps;
                row["seconds"] = median(seconds);
                row["error_u"] = error_u(scene, run.y.topRows(scene.problem.size()), *reference);
            } else {
                row["outcome"] = run.failure;
            }
            json["rows"].push_back(std::move(row));
            progress.add(1);
        }
    }
}

void add_siconos(Json& json, const PrecisionScene& scene, const PrecisionTiming& timing, Progress& progress) {
    const auto program = siconos_program();
    if (!program) return;
    progress.label(scene.name + ": " + siconos_method);
    constexpr double patience = 5;  // its steps take hundreds of times as long
    for (Json& row : siconos_rows(scene, *program, patience * timing.limit, [&] { progress.add(1); }))
        json["rows"].push_back(std::move(row));
}

/// What each method is compared with, and the methods of each.
Json references_of(const PrecisionScene& scene) {
    Json references = Json::array();
    std::vector<std::shared_ptr<const Reference>> seen;
    for (const PrecisionMethod& method : precision_methods_for(scene)) {
        const auto reference = scene.reference(method);
        const auto found = std::ranges::find(seen, reference);
        const auto place = static_cast<std::size_t>(found - seen.begin());
        if (found == seen.end()) {
            seen.push_back(reference);
            references.push_back({{"how", reference->how},
                                  {"own_error_u", reference->own_error_u},
                                  {"own_error_lambda", reference->own_error_lambda},
                                  {"distance_from_first", error_u(scene, reference->u, *seen.front())},
                                  {"methods", Json::array()}});
        }
        references[place]["methods"].push_back(method.label());
    }
    return references;
}

void measure(Json& json, const PrecisionScene& scene, const WorkPrecisionOptions& options) {
    const PrecisionTiming timing = timing_of(options);
    const auto methods = precision_methods_for(scene);
    double count = scene.gsl ? 3 * static_cast<double>(scene.tolerances.size()) : 0;
    if (scene.siconos && siconos_program()) count += static_cast<double>(scene.steps.size());
    for (const PrecisionMethod& method : methods)
        count += static_cast<double>(method.adaptive ? scene.tolerances.size() : scene.steps.size());
    Progress progress(scene.name, count);
    for (const PrecisionMethod& method : methods) {
        for (const double parameter : parameters_of(method, scene)) {
            progress.label(scene.name + ": " + method.label());
            // What takes too long takes longer still with more steps.
            const bool late = !json["rows"].empty() && json["rows"].back()["integrator"] == method.label() &&
                              json["rows"].back()["outcome"].get<std::string>().starts_with("not ") &&
                              json["rows"].back()["scene"] == scene.name;
            json["rows"].push_back(late ? untried_row(scene, method, parameter)
                                        : precision_row(scene, method, parameter, timing));
            progress.add(1);
        }
    }
    if (scene.gsl) add_gsl(json, scene, timing, progress);
    if (scene.siconos) add_siconos(json, scene, timing, progress);
    json["scenes"].push_back({{"scene", scene.name},
                              {"what", scene.what},
                              {"unknowns", scene.problem.size()},
                              {"constraints", scene.problem.constraints()},
                              {"t_end", scene.t_end},
                              {"output_times", scene.outputs},
                              {"references", references_of(scene)}});
}

}  // namespace

Json run_work_precision(const WorkPrecisionOptions& options) {
    if (options.repeats < 1)
        throw InputError("work-precision: repeats is " + std::to_string(options.repeats) + ", expected at least 1");
    const std::vector<std::string> scenes = options.scenes.empty() ? precision_scene_names() : options.scenes;
    std::vector<PrecisionScene> studied;
    for (const std::string& name : scenes) studied.push_back(precision_scene(name, options.small));
    Json json;
    json["study"] = "work-precision";
    json["size"] = options.small ? "small" : "full";
    json["repeats"] = options.repeats;
    json["limit_seconds"] = timing_of(options).limit;
    json["machine"] = machine();
    const auto siconos = siconos_program();
    json["peers"] = {{"GSL", gsl_version}, {"Siconos", siconos ? Json(peer_version(*siconos)) : Json()}};
    for (const char* list : {"scenes", "rows", "answers"}) json[list] = Json::array();
    for (const PrecisionScene& scene : studied) measure(json, scene, options);
    if (options.answers) json["answers"] = precision_answers(json["rows"], options.small);
    return json;
}

}  // namespace tact::bench
