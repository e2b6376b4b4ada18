// The tables and page of the trade-off study.
#include "../../harness/report.hpp"
#include "tradeoff.hpp"

namespace tact::bench {
namespace {

std::string word(const Json& row, const char* field) {
    return row.contains(field) && row[field].is_string() ? row[field].get<std::string>() : "-";
}
std::string size(const Json& row) {
    if (row["model"] == "full") return "-";
    return row["p"].dump().append(" / ").append(row["p_lambda"].dump());
}

std::string rows_of(const Json& json, const std::string& scene) {
    std::vector<std::vector<std::string>> lines{{"model", "integrator", "n", "dt", "p / p_lambda", "dual basis",
                                                 "seconds", "training", "relative error in the norm, %",
                                                 "squared, as the paper prints it, %"}};
    for (const Json& row : json["rows"]) {
        if (row["scene"] != scene) continue;
        std::string model = row["model"];
        if (row.value("training_model", false)) model += " (training)";
        lines.push_back({model, word(row, "integrator"), row["n"].dump(), digits(row["dt"]), size(row),
                         word(row, "dual_basis"), with_unit(row["seconds"]),
                         with_unit(row.value("training_seconds", Json())), digits(row["error_norm_percent"]),
                         digits(row["error_percent"])});
    }
    return table(lines);
}

std::string model_of(const Json& row) {
    std::string text = word(row, "integrator").append(", n = ").append(row["n"].dump());
    return row["dt"].is_number() ? text.append(", dt = ").append(digits(row["dt"])) : text;
}

std::string break_even_table(const Json& json) {
    std::vector<std::vector<std::string>> lines{{"scene", "integrator", "dual basis", "p",
                                                 "relative error in the norm, %", "full model as accurate",
                                                 "its time", "queries"}};
    for (const Json& row : json["break_even"]) {
        std::string full = "none", seconds = "-";
        if (row["full"].is_object()) {
            full = model_of(row["full"]);
            seconds = with_unit(row["full"]["seconds"]);
        }
        lines.push_back({word(row, "scene"), word(row, "integrator"), word(row, "dual_basis"), row["p"].dump(),
                         digits(norm_percent(row["error_percent"])), full, seconds, digits(row["queries"])});
    }
    return table(lines);
}

std::string rivals_table(const Json& json) {
    std::vector<std::vector<std::string>> lines{{"scene", "reduced model", "its time",
                                                 "relative error in the norm, %", "its training model's own, %",
                                                 "coarser full model", "its time", "relative error in the norm, %"}};
    for (const Json& row : json["rivals"]) {
        const Json &reduced = row["reduced"], &full = row["full"];
        lines.push_back({word(row, "scene"), model_of(reduced) + ", p = " + size(reduced),
                         with_unit(reduced["seconds"]), digits(reduced["error_norm_percent"]),
                         digits(row["training_model"]["error_norm_percent"])});
        if (full.is_null())
            lines.back().insert(lines.back().end(), {"none", "-", "-"});
        else
            lines.back().insert(lines.back().end(),
                                {model_of(full), with_unit(full["seconds"]), digits(full["error_norm_percent"])});
    }
    return table(lines);
}

}  // namespace

std::string tradeoff_table(const Json& json) { return rivals_table(json) + "\n" + break_even_table(json); }

std::string tradeoff_markdown(const Json& json) {
    std::string text =
        "# Error against run time, full and reduced\n\nSize: " + json["size"].get<std::string>() +
        ". CPU time of one thread. " + machine_line(json["machine"]) +
        ".\n\n![error against run time](tradeoff.svg)\n\n"
        "*Relative error in the norm*: the Euclidean norm of the difference of u over that of u, at the nodes that "
        "all grids "
        "share and at common times, in %, against a finer full model, the reference; at one parameter that no "
        "reduced model "
        "was trained at. *Squared, as the paper prints it*: its square, the ratio of eqs. 16 and 17. Below the error "
        "of its own training model a smaller reduced error means nothing.\n\n"
        "## The honest rivals\n\nThe reduced model of the paper's scheme with most selected rows, what its training "
        "model is "
        "off by itself, and the cheapest full model on a coarser grid whose error is no larger. Where its time is "
        "about "
        "that of the reduced model, nothing has been gained over a coarse grid.\n\n" +
        rivals_table(json) +
        "\n## From how many queries on a reduced model pays\n\nEach reduced model on the front of its integrator, "
        "its "
        "training included, against the cheapest full model of any integrator at least as accurate.\n\n" +
        break_even_table(json);
    for (const Json& reference : json["references"]) {
        text += "\n## " + reference["scene"].get<std::string>() + "\n\nReference: n = " + reference["n"].dump();
        if (reference["dt"].is_number())
            text += ", dt = " + digits(reference["dt"]) + ", " + reference["integrator"].get<std::string>();
        text += "; it is " + digits(norm_percent(reference["own_error_percent"])) +
                " % in the norm from a run half as fine. A full run's time holds its set-up; a reduced one's is "
                "online.\n\n" +
                rows_of(json, reference["scene"]);
    }
    return text;
}

const Study& tradeoff_study() {
    static const Study study =
        study_of_scenes("tradeoff", "Full and reduced models in one diagram: error against run time",
                        Measured::cpu_time, run_tradeoff, tradeoff_table, tradeoff_markdown);
    return study;
}

}  // namespace tact::bench
