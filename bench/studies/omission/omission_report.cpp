// The tables and page of the omission study.
#include <algorithm>
#include <set>

#include "../../harness/report.hpp"
#include "omission.hpp"

namespace tact::bench {
namespace {

std::string words(const Json& list) {
    std::string text;
    for (const Json& each : list) text.append(text.empty() ? "" : " ").append(each.get<std::string>());
    return text;
}

std::string parts_table(const Json& json) {
    std::vector<std::string> parts, scenes;
    for (const Json& row : json["rows"]) {
        const std::string part = row["part"], scene = row["scene"];
        if (std::ranges::find(parts, part) == parts.end()) parts.push_back(part);
        if (std::ranges::find(scenes, scene) == scenes.end()) scenes.push_back(scene);
    }
    std::vector<std::vector<std::string>> lines{{"scene"}};
    for (const std::string& part : parts) lines[0].push_back(part);
    for (const std::string& scene : scenes) {
        lines.push_back({scene});
        for (const Json& row : json["rows"])
            if (row["scene"] == scene) lines.back().emplace_back(row["used"].get<bool>() ? "used" : "-");
    }
    return table(lines);
}

std::string costs_table(const Json& json) {
    std::vector<std::vector<std::string>> lines{
        {"what is paid", "against", "baseline", "with", "over, %", "asked, %"}};
    for (const Json& row : json["costs"])
        lines.push_back({row["what"].get<std::string>(), row["baseline"].get<std::string>(),
                         with_unit(row["seconds_baseline"]), with_unit(row["seconds"]),
                         digits(row["over_percent"], 2), digits(row["asked_percent"])});
    return table(lines);
}

std::string programs_table(const Json& json) {
    std::vector<std::vector<std::string>> lines{
        {"program", "does", "components", "size, kB", "links", "leaves out", "start to end"}};
    for (const Json& row : json["programs"])
        lines.push_back({row["program"].get<std::string>(), row["does"].get<std::string>(),
                         row["components"].get<std::string>(), digits(Json(row["bytes"].get<double>() / 1024)),
                         words(row["libraries"]), words(row["left_out"]), with_unit(row["startup_seconds"])});
    return table(lines);
}

}  // namespace

std::string omission_table(const Json& json) {
    return parts_table(json) + "\n" + costs_table(json) + "\n" + programs_table(json);
}

std::string omission_markdown(const Json& json) {
    return "# What a scene leaves out\n\nSize: " + json["size"].get<std::string>() + ". " +
           machine_line(json["machine"]) + ".\n\n![what is used and what it costs](omission.svg)\n\n" +
           parts_table(json) +
           "\nFrom the problem at the middle of its parameters and the report of one run (BDF2, the chooser); the "
           "reasons "
           "are in omission.json.\n\n## What parts left out would cost\n\n" +
           costs_table(json) +
           "\nCPU time of one thread, both in turn, the least of the repeats. The march by hand keeps five vectors "
           "and one "
           "sparse Cholesky factor and certifies nothing; a negative figure says that the chooser solves faster than "
           "that.\n\n## Online programs\n\n" +
           programs_table(json) +
           "\nWhat the dynamic linker loads; wall time of a whole process, its start included, median of 21.\n";
}

const Study& omission_study() {
    static const Study study = study_of_scenes("omission", "What each scene leaves out, and what that saves",
                                               Measured::cpu_time, run_omission, omission_table, omission_markdown);
    return study;
}

}  // namespace tact::bench
