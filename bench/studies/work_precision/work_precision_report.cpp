// The work-precision study's tables and page.
#include <algorithm>
#include <set>

#include "../../harness/report.hpp"
#include "../../peers/siconos_peer.hpp"
#include "../solvers/solvers.hpp"
#include "work_precision.hpp"
#include "work_precision_scenes.hpp"

namespace tact::bench {
namespace {

std::string answers_table(const Json& json) {
    std::vector<std::vector<std::string>> rows{{"question", "target", "measured", "met"}};
    for (const Json& each : json["answers"])
        rows.push_back({each["question"].get<std::string>(), each["target"].get<std::string>(),
                        each["answer"].get<std::string>(), each["met"].get<bool>() ? "yes" : "no"});
    return rows.size() > 1 ? table(rows) : "";
}

std::string restitution(const Json& row) {
    if (row["restitution_min"].is_null()) return digits(nullptr);
    return digits(row["restitution_min"], 2).append(" to ").append(digits(row["restitution_max"], 2));
}

std::string scene_table(const Json& json, const Json& scene) {
    std::vector<std::vector<std::string>> rows{{"integrator", "parameter", "steps", "time", "error u",
                                                "error impulse", "energy drift", "restitution", "ended"}};
    for (const Json& row : json["rows"])
        if (row["scene"] == scene["scene"])
            rows.push_back({row["integrator"].get<std::string>(), row["parameter"].get<std::string>(),
                            digits(row["steps"], 9), with_unit(row["seconds"]), digits(row["error_u"], 2),
                            digits(row["error_lambda"], 2), digits(row["energy_drift"], 2), restitution(row),
                            row["outcome"].get<std::string>()});
    return table(rows);
}

/// The smallest error of each integrator's curve, what it took, and the worst energy on it.
std::string summary(const Json& json, const Json& scene) {
    std::vector<std::vector<std::string>> rows{
        {"integrator", "runs that ended", "smallest error u", "in", "its error impulse", "largest energy gain"}};
    std::vector<std::string> names;
    for (const Json& row : json["rows"]) {
        const auto name = row["integrator"].get<std::string>();
        if (row["scene"] == scene["scene"] && (names.empty() || names.back() != name)) names.push_back(name);
    }
    for (const std::string& name : names) {
        Json best;
        int runs = 0, ended = 0;
        double gain = 0;
        for (const Json& row : json["rows"]) {
            if (row["scene"] != scene["scene"] || row["integrator"] != name) continue;
            ++runs;
            if (!row["seconds"].is_number()) continue;
            ++ended;
            if (row["energy_drift"].is_number()) gain = std::max(gain, row["energy_drift"].get<double>());
            if (best.is_null() || row["error_u"] < best["error_u"]) best = row;
        }
        const auto field = [&](const char* key) { return best.is_null() ? Json() : best[key]; };
        rows.push_back({name, std::to_string(ended) + " of " + std::to_string(runs), digits(field("error_u"), 2),
                        with_unit(field("seconds")), digits(field("error_lambda"), 2), digits(gain, 2)});
    }
    return table(rows);
}

std::string references(const Json& scene) {
    std::string text;
    for (const Json& reference : scene["references"]) {
        text += "- compared with " + reference["how"].get<std::string>();
        if (reference["own_error_u"] > 0)
            text += ", itself accurate to about " + digits(reference["own_error_u"], 2) + " in u and " +
                    digits(reference["own_error_lambda"], 2) +
                    " in the impulse (half as many steps, or a tolerance 100 times looser)";
        if (reference["distance_from_first"] > 0)
            text +=
                "; it differs from the first reference by " + digits(reference["distance_from_first"], 2) + " in u";
        if (scene["references"].size() > 1) {
            text.append(":");
            for (const Json& method : reference["methods"])
                text.append(" ").append(method.get<std::string>()).append(";");
            text.pop_back();
        }
        text.append(".\n");
    }
    return text;
}

/// What takes part beside our own integrators, with its options; or that it is missing.
std::string peers(const Json& json) {
    std::string text;
    for (const auto& [name, version] : json["peers"].items())
        text += "- Peer: " + name + " " + (version.is_null() ? "not there" : version.get<std::string>()) + ". " +
                (name == "Siconos" ? siconos_options : "odeiv2, on the scene without contact, atol = rtol/1000") +
                ".\n";
    return text;
}

}  // namespace

std::string work_precision_table(const Json& json) {
    std::string text;
    for (const Json& scene : json["scenes"])
        text += scene["scene"].get<std::string>() + "\n" + summary(json, scene) + "\n";
    const std::string missing = missing_peers(json);
    if (!missing.empty()) text += missing + "\n\n";
    return text + answers_table(json);
}

std::string work_precision_markdown(const Json& json) {
    std::string text = "# Work and precision of the integrators\n\nSize: " + json["size"].get<std::string>() +
                       ". CPU time of one thread, medians over up to " + json["repeats"].dump() +
                       " marches (one where a march is long), which are given up after " +
                       digits(json["limit_seconds"]) + " s. " + machine_line(json["machine"]) +
                       ".\n\n![work-precision](work-precision.svg)\n\n";
    text +=
        "- *time*: a march on a fresh workspace; what it prepares on the way (factors, compliances) is in it, the "
        "assembly of the "
        "scene is not.\n"
        "- *error u*: the largest over the output times of |u - ref| in the norm of M, over the largest |ref|.\n"
        "- *error impulse*: of J(t), the integral of the sum of all contact forces from 0 to t: root mean square "
        "over the output "
        "times, relative. Multipliers that are means over a step (trapezoid, BDF2 without jump, central differences, "
        "Moreau-Jean) are "
        "integrated as such, the others by the trapezoid rule. Contact forces themselves hold impulses of single "
        "nodes and do not "
        "converge pointwise.\n"
        "- *energy drift*: energy at the end less the work of the load and of damping, less that at first, over the "
        "largest; positive: the scheme created energy. Impacts with e = 0 take energy: for them a loss that shrinks "
        "with the grid is right.\n"
        "- *restitution*: smallest and largest observed on single rows; `-`: no row that closed while approaching "
        "has opened.\n"
        "- Energy and restitution come from a second march that is not timed. \"adaptive\" and ida: rtol is swept, "
        "atol = rtol/1000. e=0: velocities are projected where rows close.\n";
    text += peers(json);
    for (const Json& scene : json["scenes"]) {
        text.append("\n## ").append(scene["scene"].get<std::string>()).append("\n\n");
        text.append(scene["what"].get<std::string>()).append("; ");
        text.append(scene["unknowns"].dump()).append(" unknowns, ").append(scene["constraints"].dump());
        text.append(" contact rows, t to ").append(digits(scene["t_end"])).append(", ");
        text.append(scene["output_times"].dump()).append(" output times.\n\n");
        text.append(references(scene)).append("\n").append(scene_table(json, scene));
    }
    const std::string answers = answers_table(json);
    if (!answers.empty())
        text += "\n## Targets\n\n" + answers +
                "\nBDF2's time at 1.2e-2 is interpolated on its curve (log-log); the others are measured runs. IDA: "
                "solves "
                "and preparations of contact are taken out of the time of the march; forming right sides and "
                "velocities counts as outside. "
                "The hand-written loop has the same matrices, the same prepared contact solver and no reports, "
                "observers or checks.\n";
    for (const Json& each : json["answers"]) {
        if (!each.contains("runs")) continue;
        std::vector<std::vector<std::string>> rows{
            {"integrator", "mass", "dt", "energy error at the end", "stress, worst step", "stress, mean"}};
        for (const Json& run : each["runs"])
            rows.push_back({run["integrator"].get<std::string>(), run["mass"].get<std::string>(), digits(run["dt"]),
                            digits(run["energy_error"], 2), digits(run["stress_error"], 2),
                            digits(run["mean_stress_error"], 2)});
        text.append("\n").append(each["question"].get<std::string>()).append(", relative:\n\n").append(table(rows));
    }
    return text;
}

const Study& work_precision_study() {
    static const Study study = [] {
        std::string names;
        for (const std::string& name : precision_scene_names()) names += (names.empty() ? "" : ",") + name;
        return Study{
            .name = "work-precision",
            .about = "Error against run time of every integrator, with its closing table",
            .measured = Measured::cpu_time,
            .takes_repeats = true,
            .options = {{.name = "scenes", .about = names + " (all)"},
                        {.name = "no-answers", .about = "The curves only", .kind = StudyOption::Kind::flag}},
            .run =
                [](const StudyArguments& asked) {
                    return run_work_precision({.small = asked.small,
                                               .repeats = asked.by_all ? std::min(asked.repeats, 3) : asked.repeats,
                                               .scenes = asked.list("scenes"),
                                               .answers = !asked.flag("no-answers")});
                },
            .table = work_precision_table,
            .markdown = work_precision_markdown};
    }();
    return study;
}

}  // namespace tact::bench
