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
                                                 "seconds", "training", "error, %", "error, norm %"}};
    for (const Json& row : json["rows"]) {
        if (row["scene"] != scene) continue;
        std::string model = row["model"];
        if (row.value("training_model", false)) model += " (training)";
        lines.push_back({model, word(row, "integrator"), row["n"].dump(), digits(row["dt"]), size(row),
                         word(row, "dual_basis"), with_unit(row["seconds"]),
                         with_unit(row.value("training_seconds", Json())), digits(row["error_percent"]),
                         digits(row["error_norm_percent"])});
    }
    return table(lines);
}

std::string break_even_table(const Json& json) {
    std::vector<std::vector<std::string>> lines{
        {"scene", "integrator", "dual basis", "p", "error, %", "full model as accurate", "its time", "queries"}};
    for (const Json& row : json["break_even"]) {
        std::string full = "none", seconds = "-";
        if (row["full"].is_object()) {
            full = word(row["full"], "integrator").append(", n = ").append(row["full"]["n"].dump());
            if (row["full"]["dt"].is_number()) full.append(", dt = ").append(digits(row["full"]["dt"]));
            seconds = with_unit(row["full"]["seconds"]);
        }
        lines.push_back({word(row, "scene"), word(row, "integrator"), word(row, "dual_basis"), row["p"].dump(),
                         digits(row["error_percent"]), full, seconds, digits(row["queries"])});
    }
    return table(lines);
}

}  // namespace

std::string tradeoff_table(const Json& json) { return break_even_table(json); }

std::string tradeoff_markdown(const Json& json) {
    std::string text =
        "# Error against run time, full and reduced\n\nSize: " + json["size"].get<std::string>() +
        ". CPU time of one thread. " + machine_line(json["machine"]) +
        ".\n\n![error against run time](tradeoff.svg)\n\n"
        "Errors are squared and relative (eqs. 16, 17), at the nodes that all grids share and at common times, "
        "against "
        "a finer reference. Below the error of its own training model a smaller reduced error means nothing.\n\n"
        "## From how many queries on a reduced model pays\n\nEach reduced model on the front of its integrator, its "
        "training included, against the cheapest full model of any integrator at least as accurate.\n\n" +
        break_even_table(json);
    for (const Json& reference : json["references"]) {
        text += "\n## " + reference["scene"].get<std::string>() + "\n\nReference: n = " + reference["n"].dump();
        if (reference["dt"].is_number())
            text += ", dt = " + digits(reference["dt"]) + ", " + reference["integrator"].get<std::string>();
        text += "; it is " + digits(reference["own_error_percent"]) +
                " % from a run half as fine. A full run's time holds its set-up; a reduced one's is online.\n\n" +
                rows_of(json, reference["scene"]);
    }
    return text;
}

}  // namespace tact::bench
