// The table and page of the study of bases.
#include <algorithm>

#include "../../harness/basis_recipes.hpp"
#include "../../harness/report.hpp"
#include "../../harness/study_options.hpp"
#include "bases.hpp"

namespace tact::bench {
namespace {

std::string percent(const Json& share) { return digits(Json(100 * share.get<double>())).append(" %"); }

std::vector<std::string> cells(const Json& row) {
    std::string range = "-";
    if (row["members"] != 1)
        range = digits(norm_percent(row["error_min"])).append(" - ").append(digits(norm_percent(row["error_max"])));
    return {row["dual_basis"].get<std::string>(),
            row["p"].dump() + " / " + row["p_lambda"].dump(),
            percent(row["supremizer_share"]),
            digits(row["compliance"]),
            row["error_percent"].is_null() ? row["outcome"].get<std::string>()
                                           : digits(norm_percent(row["error_percent"])),
            range,
            digits(norm_percent(row["error_median"])),
            digits(row["error_percent"]),
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
            {"dual basis", "p / p_lambda", "supremizers", "compliance", "worst relative error in the norm, %",
             "over members", "median in the norm, %", "worst, squared, as the paper prints it, %",
             "penetration / gap", "us a step", "training, s", "KKT residual", "front"}};
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
           tables(json, "## ") + what_the_errors_are +
           "- *worst*: over the test parameters, all of them outside the training set (the plates, which have no "
           "parameter: the "
           "run they were trained on); geometric mean over the members, which are neighbouring p and, for random "
           "starts, "
           "seeds. *median*: over the parameters.\n"
           "- *penetration* is the largest of [B U q - c]_- over all rows, steps and parameters, in units of max "
           "|c|.\n"
           "- *us a step* is the online run, its gap included, over its steps; statics: one query.\n"
           "- *training* makes both bases and projects; the full runs are not in it.\n"
           "- *KKT residual* is the worst of the reduced steps.\n"
           "- *front*: no other row of that scene and integrator is better both in error and in time.\n";
}

const Study& bases_study() {
    static const Study study = [] {
        std::string recipes;
        for (const std::string& name : basis_recipe_names()) recipes += (recipes.empty() ? "" : "; ") + name;
        return Study{
            .name = "bases",
            .about = "Reduced bases: error against online time of every dual basis",
            .measured = Measured::cpu_time,
            .takes_repeats = true,
            .options = {scenes_option(),
                        {.name = "integrators", .about = "bdf2,trapezoid,bdf2-without-jump (all)"},
                        {.name = "recipes",
                         .about = recipes + " (all but bodies, static modes and swaps)",
                         .delimiter = ';'}},
            .run =
                [](const StudyArguments& asked) {
                    return run_bases({asked.small, asked.by_all ? std::min(asked.repeats, 3) : asked.repeats,
                                      asked.list("scenes"), asked.list("recipes"), asked.list("integrators")});
                },
            .table = bases_table,
            .markdown = bases_markdown};
    }();
    return study;
}

}  // namespace tact::bench
