// The stability study's tables and page.
#include <algorithm>
#include <cmath>
#include <map>

#include "../../harness/report.hpp"
#include "stability.hpp"

namespace tact::bench {
namespace {

const std::vector<std::string> judgements{"right",      "honest failure", "gains energy",
                                          "penetrates", "out of time",    "wrong"};

std::string text_of(const Json& value) { return value.is_string() ? value.get<std::string>() : "-"; }

/// Values of a field in the order of their first appearance.
std::vector<std::string> distinct(const Json& rows, const char* field) {
    std::vector<std::string> values;
    for (const Json& row : rows)
        if (std::ranges::find(values, text_of(row[field])) == values.end()) values.push_back(text_of(row[field]));
    return values;
}

std::string counts(const Json& json) {
    std::vector<std::vector<std::string>> rows{{"integrator"}};
    rows.front().insert(rows.front().end(), judgements.begin(), judgements.end());
    for (const char* field : {"energy, most", "penetration, most", "KKT residual, most"})
        rows.front().push_back(field);
    for (const std::string& name : distinct(json["rows"], "integrator")) {
        std::map<std::string, int> count;
        double energy = -1, penetration = -1, kkt = -1;
        const auto raise = [](double& most, const Json& value) {
            if (value.is_number()) most = std::max(most, value.get<double>());
        };
        for (const Json& row : json["rows"]) {
            if (row["integrator"] != name) continue;
            ++count[text_of(row["judgement"])];
            raise(energy, row["energy_ratio_max"]);
            raise(penetration, row["penetration_max"]);
            raise(kkt, row["kkt_residual_max"]);
        }
        std::vector<std::string> line{name};
        for (const std::string& judgement : judgements) line.push_back(std::to_string(count[judgement]));
        line.push_back(energy < 0 ? "-" : digits(energy));
        line.push_back(penetration < 0 ? "-" : digits(penetration, 2));
        line.push_back(kkt < 0 ? "-" : digits(kkt, 2));
        rows.push_back(std::move(line));
    }
    return table(rows);
}

/// What an integrator gets wrong and does not say: a march that gains energy or penetrates and ends "converged".
std::string silent(const Json& json) {
    int runs = 0, marches = 0;
    for (const Json& row : json["rows"]) {
        ++runs;
        const bool bad = row["judgement"] == "gains energy" || row["judgement"] == "penetrates";
        if (bad && row["outcome"] == "converged" && row["message"].is_null()) ++marches;
    }
    return std::to_string(marches) + " of " + std::to_string(runs) +
           " runs gain energy or penetrate by more than the measures below and end `converged` without a message.\n";
}

std::vector<std::string> line_of(const Json& row) {
    return {row["case"].get<std::string>(),
            row["integrator"].get<std::string>(),
            text_of(row["judgement"]),
            text_of(row["outcome"]),
            row["steps"].is_null() ? "-" : row["steps"].dump(),
            digits(row["energy_ratio_max"]),
            digits(row["penetration_max"], 2),
            digits(row["kkt_residual_max"], 2),
            digits(row["error"], 2)};
}

const std::vector<std::string> columns{"case",   "integrator",  "judged",       "ended", "steps",
                                       "energy", "penetration", "KKT residual", "error"};

/// What did not end well, with what was said. Energy gained and penetration have tables of their own or are by construction.
std::string exceptions(const Json& json) {
    std::vector<std::vector<std::string>> rows{columns};
    rows.front().emplace_back("message");
    for (const Json& row : json["rows"]) {
        const Json& judged = row["judgement"];
        if (judged == "right" || judged == "gains energy" || judged == "penetrates") continue;
        rows.push_back(line_of(row));
        rows.back().push_back(text_of(row["message"]));
    }
    return rows.size() == 1 ? "none\n" : table(rows);
}

/// Energy gained, the largest of each integrator in each group.
std::string gains(const Json& json) {
    const std::vector<std::string> groups = distinct(json["rows"], "group");
    std::vector<std::vector<std::string>> rows{{"energy over that at first"}};
    rows.front().insert(rows.front().end(), groups.begin(), groups.end());
    for (const std::string& name : distinct(json["rows"], "integrator")) {
        std::vector<std::string> line{name};
        bool any = false;
        for (const std::string& group : groups) {
            double most = 0;
            for (const Json& row : json["rows"])
                if (row["integrator"] == name && row["group"] == group && row["judgement"] == "gains energy")
                    // No number is one beyond any.
                    most = std::max(
                        most, row["energy_ratio_max"].is_null() ? HUGE_VAL : row["energy_ratio_max"].get<double>());
            any = any || most > 0;
            line.push_back(most > 0 ? digits(most, 4) : "-");
        }
        if (any) rows.push_back(std::move(line));
    }
    return rows.size() == 1 ? "none\n" : table(rows);
}

std::string range(const Json& row) {
    const auto text = [](const Json& e) {
        return e.is_number() && std::abs(e.get<double>()) < 1e-9 ? "0" : digits(e, 2);
    };
    const std::string low = text(row["e_min"]), high = text(row["e_max"]);
    const std::string failed = row["failed"] > 0 ? " (" + row["failed"].dump() + " failed)" : "";
    return (low == high ? low : low + " to " + high) + failed;
}

/// One line an integrator: the mass over its phases, the bar as the step falls.
std::string restitutions(const Json& json) {
    std::vector<double> steps;
    for (const Json& row : json["restitution"])
        if (row["scene"] == "bar" && std::ranges::find(steps, row["dt"].get<double>()) == steps.end())
            steps.push_back(row["dt"].get<double>());
    std::vector<std::vector<std::string>> rows{{"integrator", "mass, over the phases"}};
    for (const double dt : steps) rows.front().push_back("bar, dt = " + digits(dt));
    for (const std::string& name : distinct(json["restitution"], "integrator")) {
        std::vector<std::string> line{name, "-"};
        line.resize(2 + steps.size(), "-");
        for (const Json& row : json["restitution"]) {
            if (row["integrator"] != name) continue;
            if (row["scene"] == "mass") {
                line[1] = range(row);
                continue;
            }
            const auto at = std::ranges::find(steps, row["dt"].get<double>()) - steps.begin();
            line[2 + static_cast<std::size_t>(at)] = digits(row["e_min"]);
        }
        rows.push_back(std::move(line));
    }
    return table(rows);
}

std::string membrane(const Json& json) {
    std::vector<std::vector<std::string>> rows{{"integrator", "dt", "nearest e", "relative distance in the norm, %"}};
    if (!json["membrane"].empty())
        for (const Json& each : json["membrane"][0]["distances"])
            rows.front().push_back("to e = " + digits(each["e"], 2));
    for (const Json& row : json["membrane"]) {
        rows.push_back({row["integrator"].get<std::string>(), digits(row["dt"]), digits(row["nearest_e"], 2),
                        digits(norm_percent(row["distance_percent"]), 2)});
        for (const Json& each : row["distances"]) rows.back().push_back(digits(norm_percent(each["percent"]), 2));
    }
    return table(rows);
}

std::string reduced(const Json& json) {
    std::vector<std::vector<std::string>> rows{{"integrator", "p", "relative errors in the norm, %",
                                                "geometric mean in the norm, %", "over BDF2's",
                                                "gap larger by 1e-6: relative change in the norm, %"}};
    for (const Json& row : json["reduced_error"]) {
        std::string errors;
        for (const Json& error : row["percent"])
            errors.append(errors.empty() ? "" : " ").append(digits(norm_percent(error), 2));
        Json change;
        for (const Json& each : json["gap_sensitivity"])
            if (each["integrator"] == row["integrator"]) change = norm_percent(each["change_percent"]);
        rows.push_back({row["integrator"].get<std::string>(),
                        row["p"].front().dump() + " to " + row["p"].back().dump(), errors,
                        digits(norm_percent(row["geometric_mean_percent"])),
                        digits(std::sqrt(row["over_bdf2"].get<double>())), digits(change, 2)});
    }
    return table(rows);
}

}  // namespace

std::string stability_table(const Json& json) {
    std::string text = counts(json) + "\n" + gains(json) + "\nfailed or wrong\n" + exceptions(json);
    if (!json["restitution"].empty()) text += "\nrestitution\n" + restitutions(json);
    if (!json["membrane"].empty()) text += "\nmembrane\n" + membrane(json);
    if (!json["reduced_error"].empty()) text += "\nreduced plates\n" + reduced(json);
    return text;
}

std::string stability_markdown(const Json& json) {
    std::string text =
        "# Hard cases\n\nSize: " + json["size"].get<std::string>() + ". " + machine_line(json["machine"]) +
        ".\n\n![stability](stability.svg)\n\n"
        "Every integrator, with each restitution it takes, on steps from 1e-3 to 1e3 of the first period, "
        "stiffnesses, ratios of masses, stiffnesses and thicknesses, gaps, speeds, rest, grazing, repeated "
        "rows, floating bodies, load jumps and long runs; quasi-static on equilibria. Each run in a process of "
        "its own with a limit of CPU time.\n\n" +
        counts(json) + "\n" + silent(json) + "\n";
    text +=
        "- *right*: ended at the end of the grid; every state finite; every step certified (KKT residual at most "
        "1e-9); "
        "no energy gained; no penetration; and, where every consistent method must be near it, the error within the "
        "case's "
        "limit. A gap that is negative at first is right when it is rejected by an InputError that names its row.\n"
        "- *honest failure*: it ended earlier, and said so by an outcome or an error; nothing it returned was "
        "wrong.\n"
        "- *gains energy*: mechanical energy, less that at first and the work of the load, was once above 1e-6 of "
        "its scale "
        "(energy at first plus the largest work; 2 % where the load jumps, without bound where an accepted "
        "penetration is "
        "repaired) and above 64 roundings of |u|'|K||u|. *energy* is 1 plus the largest such gain over the scale, "
        "rounding "
        "included.\n"
        "- *penetrates*: by more than 1e-9 of the largest |B||u| + |c| of the run, which is the unit of "
        "*penetration*. "
        "Moreau-Jean closes gaps at velocity level: it does so by construction.\n"
        "- *out of time*: the limit of CPU time; *wrong*: NaN, an uncertified step, a crash, a limit of the error "
        "passed, a "
        "rejection missed.\n"
        "- *error*: of u at the end, largest entry, relative to the motion, against the exact motion (with the "
        "integrator's own "
        "restitution for rigid masses) or, for repeated rows, against the same integrator without them; - where none "
        "is "
        "known. Steps of a tenth of a period and more resolve nothing: their errors are of order one and no fault.\n";
    text += "\n## Energy gained\n\n" + gains(json) + "\n## What failed or is wrong\n\n" + exceptions(json);
    if (!json["restitution"].empty())
        text +=
            "\n## Restitution\n\nA single mass thrown at a stop, speed after over speed before, least and most over "
            "40 phases of "
            "the impact within its step: a scheme without an impact law has no restitution of its own. An elastic "
            "bar "
            "that is free at both ends, mean velocity after over before (exact: 1), as the step falls.\n\n" +
            restitutions(json);
    if (!json["membrane"].empty())
        text +=
            "\nThe membrane over its obstacle, to t = 2: the relative distance, Euclidean norms of the displacements "
            "of all nodes and "
            "steps, between each integrator's motion and those of the "
            "trapezoid "
            "with e = 0 to 1 at half the smallest step: which law it converges to as the step falls.\n\n" +
            membrane(json);
    if (!json["reduced_error"].empty())
        text +=
            "\n## Reduced plates\n\nThe relative error of the reduced plates, Euclidean norms of the displacements "
            "of all nodes "
            "and steps, against the full run of the same integrator, which "
            "trained them "
            "(POD of u, NNMF of lambda, p = p_lambda), and by how much the reduced motion changes when the gap grows "
            "by "
            "1e-6 of itself (p in the middle).\n\n" +
            reduced(json);
    return text + "\nEvery row is in stability.json.\n";
}

const Study& stability_study() {
    static const Study study{
        .name = "stability",
        .about = "Every integrator on hard cases: ended right, or honestly",
        .measured = Measured::errors,
        .sizes = "full: a million steps, plates 100 x 100; small: seconds",
        .options = {{.name = "groups", .about = "step,stiffness,ratio,gap,speed,... (all)"},
                    {.name = "integrators",
                     .about = "As case takes them, with blanks between (all)",
                     .delimiter = 0}},
        .run =
            [](const StudyArguments& asked) {
                return run_stability({asked.small, asked.list("groups"), asked.list("integrators")});
            },
        .table = stability_table,
        .markdown = stability_markdown};
    return study;
}

}  // namespace tact::bench
