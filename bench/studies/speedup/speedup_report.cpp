// The speed-up study's table and page.
#include "../../harness/report.hpp"
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
        put(digits(row["relative_error_percent"]));
        put(digits(row["median_relative_error_percent"]));
        put(digits(row["relative_error_norm"]));
        put(row["test_parameters"].dump());
        put(digits(row["max_penetration"]) + " (" + digits(row["max_penetration_over_gap_scale"]) + ")");
        put(digits(row["max_kkt_residual_full"], 2));
        put(digits(row["max_kkt_residual_reduced"], 2));
    }
    return rows;
}

}  // namespace

std::string speedup_table(const Json& json) {
    return table(columns(json, {{"scene"},
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
                                {"worst error, %"},
                                {"median error, %"},
                                {"worst error, norm"},
                                {"parameters tested"},
                                {"worst penetration (of the gap)"},
                                {"worst KKT residual, full"},
                                {"worst KKT residual, reduced"}}));
}

std::string speedup_markdown(const Json& json) {
    std::string text = "# Speed-ups of the reduced models\n\n";
    text += "Size: " + json["size"].get<std::string>() + ". Medians over " + json["repeats"].dump() +
            " repeats of CPU time of one thread. Bases: " +
            (json["bases"] == "paper"
                 ? "the paper's method (POD and NNMF of equal size; in statics the snapshots themselves)"
                 : "our default (contact at selected rows, in marches with a compliance of .3; "
                   "`--bases paper` is the paper's method)") +
            std::string(". ") + machine_line(json["machine"]) + ".\n\n![speed-ups](speedup.svg)\n\n";
    text += speedup_table(json) + "\n";
    text +=
        "- *full run*: the fastest full solver we have, one further run after the first: what does not depend on the "
        "query"
        " (factors, analyses, columns of the compliance) stays. *Nothing cached*: the first run.\n"
        "- *reduced run*: the online part, everything that depends on the query: the gap of eq. 19 and its projection"
        " included, the displacement field not reconstructed.\n"
        "- *interior point* is IPOPT, the paper's kind of full solver; the paper's speed-up compares with that row.\n"
        "- *worst error* is eq. 16 or 17 as printed, a ratio of squared norms, in per cent; *norm* is its square "
        "root, not"
        " in per cent.\n";
    for (const Json& row : json["rows"]) {
        text += "- " + row["scene"].get<std::string>() + ": error over " + row["error_over"].get<std::string>() + ".";
        for (const Json& entry : row["extrapolated"])
            text += " \\*" + entry["field"].get<std::string>() + ": " + entry["how"].get<std::string>() + ".";
        text += "\n";
    }
    return text;
}

}  // namespace tact::bench
