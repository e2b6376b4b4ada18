// The speed-up study's table and page.
#include "../../harness/report.hpp"
#include "../../harness/study_options.hpp"
#include "speedup.hpp"

namespace tact::bench {
namespace {

std::string size_of(const Json& row) { return row["p"].dump() + " / " + row["p_lambda"].dump(); }

std::string extrapolated_mark(const Json& row, const std::string& field) {
    for (const Json& entry : row["extrapolated"])
        if (entry["field"] == field) return " *";
    return "";
}

std::string seconds(const Json& row, const std::string& field) {
    return with_unit(row[field]) + extrapolated_mark(row, field);
}

std::vector<std::vector<std::string>> columns(const Json& json, const std::vector<std::vector<std::string>>& lines) {
    std::vector<std::vector<std::string>> rows = lines;
    for (const Json& row : json["rows"]) {
        std::size_t k = 0;
        const auto put = [&](const std::string& cell) { rows[k++].push_back(cell); };
        put(row["scene"].get<std::string>());
        put(row["method"].get<std::string>());
        put(row["unknowns"].dump() + " / " + row["contact_constraints"].dump());
        put(size_of(row));
        put(row["steps"].dump());
        put(seconds(row, "full_seconds"));
        put(seconds(row, "full_cold_seconds"));
        put(row["full_method"].get<std::string>());
        put(seconds(row, "full_klu_refactor_seconds"));
        put(seconds(row, "interior_point_seconds"));
        put(seconds(row, "reduced_seconds"));
        put(seconds(row, "reduced_seconds_per_step"));
        put(seconds(row, "training_seconds"));
        put(digits(row["speedup"]));
        put(digits(row["speedup_vs_klu_refactor"]));
        put(digits(row["speedup_vs_interior_point"]));
        put(digits(row["paper_speedup"], 4));
        put(digits(norm_percent(row["relative_error_percent"])));
        put(digits(norm_percent(row["median_relative_error_percent"])));
        put(digits(row["relative_error_percent"]));
        put(row["test_parameters"].dump());
        put(digits(row["max_penetration"]) + " (" + digits(row["max_penetration_over_gap_scale"]) + ")");
        put(digits(row["max_kkt_residual_full"], 2));
        put(digits(row["max_kkt_residual_reduced"], 2));
    }
    return rows;
}

/// Whether the machine was ours alone, as far as its load says: one process of two is this one.
std::string others(const Json& json) {
    if (!json.contains("load_average") || !json["load_average"].is_number()) return "";
    const double load = json["load_average"];
    const std::string said = " Load average of the machine at the end: " + digits(load, 2);
    return said + (load > 1.5 ? ": other processes ran beside it, which disturbs times and less their ratios."
                              : ": nothing else ran beside it.");
}

}  // namespace

std::string speedup_table(const Json& json) {
    return table(columns(json, {{"scene"},
                                {"method"},
                                {"unknowns / constraints"},
                                {"p / p_lambda"},
                                {"steps"},
                                {"full run"},
                                {"full run, nothing cached"},
                                {"full method"},
                                {"full run, KLU refactorisation"},
                                {"full run, interior point"},
                                {"reduced run"},
                                {"reduced, per step"},
                                {"training"},
                                {"speed-up"},
                                {"speed-up vs KLU refactorisation"},
                                {"speed-up vs interior point"},
                                {"the paper's speed-up"},
                                {"worst relative error in the norm, %"},
                                {"median relative error in the norm, %"},
                                {"worst, squared, as the paper prints it, %"},
                                {"parameters tested"},
                                {"worst penetration (of the gap)"},
                                {"worst KKT residual, full"},
                                {"worst KKT residual, reduced"}}));
}

std::string speedup_markdown(const Json& json) {
    std::string text = "# Speed-ups of the reduced models\n\n";
    text += "Size: " + json["size"].get<std::string>() + ". Medians over " + json["repeats"].dump() +
            " repeats of CPU time of one thread. " + machine_line(json["machine"]) + "." + others(json) +
            "\n\n![speed-ups](speedup.svg)\n\n";
    text += speedup_table(json) + "\n";
    text +=
        "- *full run*: the fastest full solver we have, one further run after the first: what does not depend on the "
        "query"
        " (factors, analyses, columns of the compliance) stays. *Nothing cached*: the first run.\n"
        "- *reduced run*: the online part, everything that depends on the query: the gap of eq. 19 and its projection"
        " included, the displacement field not reconstructed.\n"
        "- *interior point* is IPOPT, the paper's kind of full solver; the paper's speed-up compares with that row.\n"
        "- *method*: *the paper's* is its own at its own sizes: bases p = p_lambda, POD for u and NNMF for lambda "
        "(in statics the "
        "snapshots themselves), the samples of its greedy search, no compliance. *Ours* has contact at selected "
        "rows, in "
        "marches with a compliance of .3, and more modes. Both are trained and timed here; their full runs are the "
        "same.\n";
    text += what_the_errors_are;
    for (const Json& row : json["rows"]) {
        text += "- " + row["scene"].get<std::string>() + ", " + row["method"].get<std::string>() + ": error over " +
                row["error_over"].get<std::string>() + ".";
        for (const Json& entry : row["extrapolated"])
            text += " \\*" + entry["field"].get<std::string>() + ": " + entry["how"].get<std::string>() + ".";
        text += "\n";
    }
    return text;
}

const Study& speedup_study() {
    static const Study study{
        .name = "speedup",
        .about = "Table I: online speed-ups of the three contact problems",
        .measured = Measured::cpu_time,
        .takes_repeats = true,
        .options = {{.name = "bases",
                     .about = "default: contact at selected rows; paper: the paper's method",
                     .kind = StudyOption::Kind::choice,
                     .choices = {"both", "default", "paper"}},
                    scenes_option("Rows wanted: static-obstacle,dynamic-obstacle,two-plates (all)")},
        .run =
            [](const StudyArguments& asked) {
                return run_speedup({asked.small, asked.repeats, asked.choice("bases", "both"), asked.list("scenes")});
            },
        .table = [](const Json& json) { return speedup_table(json) + "* extrapolated from a sample of steps\n"; },
        .markdown = speedup_markdown};
    return study;
}

}  // namespace tact::bench
