// The greedy study's table and page.
#include <algorithm>

#include "../../harness/report.hpp"
#include "../../harness/timing.hpp"
#include "greedy_study.hpp"

namespace tact::bench {
namespace {

using Cells = std::vector<std::vector<std::string>>;

/// Worst errors of one scene: an iteration a line, a selection a column.
Cells iterations(const Json& rows, const std::string& scene) {
    std::vector<std::string> header{"iteration", "p"};
    Cells lines;
    for (const Json& row : rows) {
        if (row["scene"] != scene || !row.contains("iteration")) continue;
        const std::string selection = row["selection"].get<std::string>();
        if (header.back() != selection) header.push_back(selection);
        const auto k = row["iteration"].get<std::size_t>();
        if (lines.size() < k) lines.push_back({row["iteration"].dump(), row["p"].dump()});
        lines[k - 1].push_back(digits(norm_percent(row["worst_error_percent"])));
    }
    for (auto& line : lines) line.resize(header.size(), "-");
    lines.insert(lines.begin(), header);
    return lines;
}

std::string random_lines(const Json& rows) {
    Cells lines{{"random samples", "repeats", "best", "median", "worst"}};
    std::vector<int> counts;
    for (const Json& row : rows)
        if (row.contains("samples") && std::ranges::find(counts, row["samples"].get<int>()) == counts.end())
            counts.push_back(row["samples"].get<int>());
    for (const int count : counts) {
        std::vector<double> errors;
        for (const Json& row : rows)
            if (row.contains("samples") && row["samples"] == count)
                errors.push_back(norm_percent(row["worst_error_percent"]).get<double>());
        lines.push_back({std::to_string(count), std::to_string(errors.size()),
                         digits(*std::ranges::min_element(errors)), digits(median(errors)),
                         digits(*std::ranges::max_element(errors))});
    }
    return table(lines);
}

std::string random_part(const Json& rows, const std::string& scene) {
    if (scene != "static-obstacle") return "";
    return "Worst relative errors in the norm, %, of bases from Latin hypercubes, over the repeats:\n\n" +
           random_lines(rows) + "\n";
}

std::vector<std::string> scenes_of(const Json& rows) {
    std::vector<std::string> scenes;
    for (const Json& row : rows) {
        std::string scene = row["scene"].get<std::string>();
        if (std::ranges::find(scenes, scene) == scenes.end()) scenes.push_back(std::move(scene));
    }
    return scenes;
}

std::string claim_lines(const Json& claims) {
    Cells lines{{"the paper's claim", "scene", "figure", "holds"}};
    for (const Json& claim : claims)
        lines.push_back({claim["claim"].get<std::string>(), claim["scene"].get<std::string>(),
                         digits(claim["figure"]), claim["holds"].get<bool>() ? "yes" : "no"});
    return table(lines);
}

}  // namespace

std::string greedy_table(const Json& json) {
    const Json& rows = json["rows"];
    std::string text;
    for (const std::string& scene : scenes_of(rows))
        text += scene + ", worst relative error in the norm, %, against the full runs\n" +
                table(iterations(rows, scene)) + "\n" + random_part(rows, scene);
    return text + claim_lines(json["claims"]);
}

std::string greedy_markdown(const Json& json) {
    const Json& rows = json["rows"];
    std::string text = "# Convergence of the greedy search\n\nSize: " + json["size"].get<std::string>() + ". " +
                       machine_line(json["machine"]) + ".\n\n![worst errors](greedy.svg)\n\n";
    text +=
        "The worst relative error in the norm, %, against full runs at test parameters that are no candidates. "
        "Columns are the weights (alpha_1, alpha_2, alpha_3) of the indicator, eq. 14; *true error* "
        "chooses by the error itself at all candidates, which no real training can afford. Candidates lie in the "
        "middle of equal cells, as the paper's must, for which (0.6, 0.6) is no candidate; *closed grid*: as many, "
        "with the faces of the box among them.\n\n";
    for (const std::string& scene : scenes_of(rows)) {
        const auto row = std::ranges::find_if(rows, [&](const Json& each) { return each["scene"] == scene; });
        text += "## " + scene + ": " + (*row)["test_parameters"].dump() + " test parameters\n\n" +
                table(iterations(rows, scene)) + "\n" + random_part(rows, scene);
    }
    return text + "## What the errors are\n\n" + what_the_errors_are +
           "\n## Claims\n\nRatios of errors as the paper prints them, squared; their roots are the ratios in the "
           "norm.\n\n" +
           claim_lines(json["claims"]);
}

const Study& greedy_study() {
    static const Study study =
        study_of_scenes("greedy", "Figures 3 and 6: convergence of the greedy search, by every indicator",
                        Measured::errors, run_greedy, greedy_table, greedy_markdown);
    return study;
}

}  // namespace tact::bench
