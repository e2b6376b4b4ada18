// The solvers study's tables and page.
#include <algorithm>

#include "../../harness/report.hpp"
#include "../../harness/study_options.hpp"
#include "solvers.hpp"

namespace tact::bench {
namespace {

/// The fastest of a problem's rows that were answered, ours or the peers'; null without one.
Json fastest(const Json& json, const Json& problem, bool peer) {
    Json best;
    for (const Json& row : json["rows"])
        if (row["problem"] == problem["problem"] && row["peer"] == peer && row.value("outcome", "") == "converged" &&
            row["solver"] != "chooser" && (best.is_null() || row["seconds_median"] < best["seconds_median"]))
            best = row;
    return best;
}

Json row_of(const Json& json, const Json& problem, const std::string& solver) {
    for (const Json& row : json["rows"])
        if (row["problem"] == problem["problem"] && row["solver"] == solver) return row;
    return nullptr;
}

std::string named(const Json& row) {
    return row.is_null() ? "-" : with_unit(row["seconds_median"]) + ", " + row["solver"].get<std::string>();
}

std::string summary(const Json& json) {
    std::vector<std::vector<std::string>> rows{{"problem", "n", "m", "chooser", "fastest strategy", "fastest peer",
                                                "peer / chooser", "permuted / structured"}};
    for (const Json& problem : json["problems"]) {
        const Json chooser = row_of(json, problem, "chooser"), peer = fastest(json, problem, true);
        Json ratio, permuted;
        if (!peer.is_null() && !chooser.is_null() && chooser["seconds_median"].is_number())
            ratio = peer["seconds_median"].get<double>() / chooser["seconds_median"].get<double>();
        for (const Json& each : json["numbering"])
            if (each["problem"] == problem["problem"]) permuted = each["ratio"];
        rows.push_back({problem["problem"].get<std::string>(), problem["unknowns"].dump(),
                        problem["constraints"].dump(), chooser.is_null() ? "-" : with_unit(chooser["seconds_median"]),
                        named(fastest(json, problem, false)), named(peer), digits(ratio), digits(permuted)});
    }
    return table(rows);
}

std::string all_rows(const Json& json) {
    std::vector<std::vector<std::string>> rows{
        {"problem", "solver", "median", "min", "iterations", "KKT residual", "error", "ended", "how"}};
    for (const Json& row : json["rows"])
        rows.push_back(
            {row["problem"].get<std::string>(), row["solver"].get<std::string>(), with_unit(row["seconds_median"]),
             with_unit(row["seconds_min"]), digits(row["iterations"]), digits(row["kkt_residual"], 2),
             digits(row["solution_error"], 2),
             row.contains("message") ? row["message"].get<std::string>() : row["outcome"].get<std::string>(),
             row.value("how", "-")});
    return table(rows);
}

std::string growth_rows(const Json& growth) {
    std::vector<std::vector<std::string>> rows{{"n", "unknowns", "steps (in contact)", "most rows", "set-up",
                                                "free step", "contact step", "bytes / unknown", "solved by"}};
    for (const Json& point : growth["points"]) {
        if (point.contains("error")) {
            rows.push_back({point["n"].dump(), "-", "-", "-", "-", "-", "-", "-", point["error"].get<std::string>()});
            continue;
        }
        std::string steps = point["steps"].dump() + " (" + point["contact_steps"].dump() + ")";
        if (point["outcome"] != "converged") steps += ", " + point["outcome"].get<std::string>();
        rows.push_back({point["n"].dump(), point["unknowns"].dump(), steps, point["most_active"].dump(),
                        with_unit(point["prepare_seconds"]), with_unit(point["free_seconds"]),
                        with_unit(point["contact_seconds"]), digits(point["bytes_per_unknown"]),
                        point["strategy"].get<std::string>()});
    }
    const auto exponent = [&](const char* field) {
        return growth[field].is_null() ? "-" : "N^" + digits(growth[field]);
    };
    rows.push_back({"fit", "", "", "", "", exponent("free_exponent"), exponent("contact_exponent"),
                    exponent("memory_exponent") + " in all", ""});
    return table(rows);
}

}  // namespace

std::string solvers_table(const Json& json) {
    std::string text = summary(json) + "\n" + all_rows(json);
    for (const Json& growth : json["growth"])
        text += "\ngrowth, " + growth["scene"].get<std::string>() + "\n" + growth_rows(growth);
    const std::string missing = missing_peers(json);
    return missing.empty() ? text : text + "\n" + missing + "\n";
}

std::string solvers_markdown(const Json& json) {
    std::string text = "# Contact solvers\n\n";
    text += "Size: " + json["size"].get<std::string>() + ". Medians over up to " + json["repeats"].dump() +
            " repeats of CPU time of one thread. " + machine_line(json["machine"]) + ".";
    for (const auto& [name, version] : json["peers"].items())
        text += " " + name + " " + (version.is_null() ? "not there" : version.get<std::string>()) + ".";
    text += "\n\n![solvers](solvers.svg)\n\n" + summary(json) + "\n";
    for (const Json& problem : json["problems"])
        text += "- *" + problem["problem"].get<std::string>() + "*: " + problem["what"].get<std::string>() +
                "; reference: KKT residual " + digits(problem["reference_kkt_residual"], 2) +
                ", two strategies agree to " + digits(problem["reference_agreement"], 2) + ".\n";
    text +=
        "- *chooser* is what a user gets; *fastest strategy* leaves the chooser out. *Permuted*: the same matrices "
        "in "
        "a random numbering of the unknowns and of the rows.\n"
        "- *KKT residual* is the scaled one of `lib/kkt.hpp`, for peers too, with multipliers read off Au - b; "
        "*error* "
        "is in max norm, relative to the reference. An interior point leaves small multipliers on every row, which "
        "its "
        "largest multiplier does not dwarf where nothing is in contact.\n\n## Every solver\n\n" +
        all_rows(json) + "\n## Growth\n\n";
    for (const Json& growth : json["growth"])
        text += growth["scene"].get<std::string>() +
                ", the chooser, medians over the steps with and without contact; memory is the peak of the whole "
                "run.\n\n" +
                growth_rows(growth) + "\n";
    return text;
}

const Study& solvers_study() {
    static const Study study{
        .name = "solvers",
        .about = "Every contact strategy, and peers, on the three contact problems",
        .measured = Measured::cpu_time,
        .takes_repeats = true,
        .options = {{.name = "peers",
                     .about = "Compare with IPOPT and PETSc, those that are there",
                     .kind = StudyOption::Kind::flag},
                    scenes_option()},
        .run =
            [](const StudyArguments& asked) {
                return run_solvers({.small = asked.small,
                                    .repeats = asked.by_all ? std::min(asked.repeats, 3) : asked.repeats,
                                    .peers = asked.by_all || asked.flag("peers"),
                                    .scenes = asked.list("scenes")});
            },
        .table = solvers_table,
        .markdown = solvers_markdown};
    return study;
}

}  // namespace tact::bench
