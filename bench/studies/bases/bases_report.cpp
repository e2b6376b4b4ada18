// The table and page of the study of bases.
#include <algorithm>

#include "../../harness/report.hpp"
#include "bases.hpp"

namespace tact::bench {
namespace {

std::string percent(const Json& share) { return digits(Json(100 * share.get<double>())).append(" %"); }

std::vector<std::string> cells(const Json& row) {
    std::string range = "-";
    if (row["members"] != 1) range = digits(row["error_min"]).append(" - ").append(digits(row["error_max"]));
    return {row["dual_basis"].get<std::string>(),
            row["p"].dump() + " / " + row["p_lambda"].dump(),
            percent(row["supremizer_share"]),
            digits(row["compliance"]),
            row["error_percent"].is_null() ? row["outcome"].get<std::string>() : digits(row["error_percent"]),
            range,
            digits(row["error_median"]),
            digits(row["penetration"]),
            digits(row["us_per_step"]),
            digits(row["training_seconds"]),
            digits(row["kkt_residual"], 2),
            row["pareto"].get<bool>() ? "yes" : ""};
}

/// A table a setting: scene, integrator and training set.
std::string tables(const Json& json, const std::string& heading) {
    std::string text;
    for (const Json& training : json["trainings"]) {
        std::vector<std::vector<std::string>> lines{
            {"dual basis", "p / p_lambda", "supremizers", "compliance", "worst error, %", "over members",
             "median error, %", "penetration / gap", "us a step", "training, s", "KKT residual", "front"}};
        for (const Json& row : json["rows"])
            if (row["scene"] == training["scene"] && row["integrator"] == training["integrator"] &&
                row["training"] == training["training"])
                lines.push_back(cells(row));
        text += heading + training["scene"].get<std::string>();
        if (training["integrator"] != "none") text += ", " + training["integrator"].get<std::string>();
        text += ", trained on " + training["training"].get<std::string>() + "\n\n" + training["samples"].dump() +
                " full runs in " + with_unit(training["seconds_full"]) + ": " + training["snapshots"].dump() +
                " snapshots, " + training["contact_snapshots"].dump() + " of them in contact; tested at " +
                training["test_parameters"].dump() + " parameters.\n\n" + table(lines) + "\n";
    }
    return text;
}

}  // namespace

std::string bases_table(const Json& json) { return tables(json, ""); }

std::string bases_markdown(const Json& json) {
    return "# Bases: error against online time\n\nSize: " + json["size"].get<std::string>() +
           ". CPU time of one thread, medians over " + json["repeats"].dump() + " repeats. " +
           machine_line(json["machine"]) + ".\n\n![error against time of a step](bases.svg)\n\n" +
           tables(json, "## ") +
           "- *worst error* is eq. 16 or 17 as printed, a ratio of squared norms in per cent, the worst over the "
           "test "
           "parameters, all of them outside the training set (the plates, which have no parameter, against the run "
           "they "
           "were trained on); the geometric mean over the members: neighbouring p and, for random starts, seeds.\n"
           "- *penetration* is the largest of [B U q - c]_- over all rows, steps and parameters, in units of max "
           "|c|.\n"
           "- *us a step* is the online run, its gap included, over its steps; statics: one query.\n"
           "- *training* makes both bases and projects; the full runs are not in it.\n"
           "- *KKT residual* is the worst of the reduced steps.\n"
           "- *front*: no other row of that scene and integrator is better both in error and in time.\n";
}

}  // namespace tact::bench
