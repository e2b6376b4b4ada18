// The histories study's table and page.
#include "../../harness/report.hpp"
#include "histories.hpp"

namespace tact::bench {

std::string histories_table(const Json& json) {
    std::vector<std::vector<std::string>> lines{
        {"figures", "scene", "gamma", "p / p_lambda", "relative error in the norm, %",
         "with singular vectors, in the norm, %", "squared, as the paper prints it, %", "the paper"}};
    for (const Json& row : json["rows"]) {
        std::string gamma;
        for (const Json& x : row["gamma"]) gamma += (gamma.empty() ? "" : ", ") + digits(x);
        lines.push_back(
            {row["figures"].get<std::string>(), row["scene"].get<std::string>(), gamma,
             row["p"].dump() + " / " + row["p_lambda"].dump(), digits(norm_percent(row["relative_error_percent"])),
             row.contains("singular_vectors_outcome") ? "fails"
                                                      : digits(norm_percent(row["singular_vectors_error_percent"])),
             digits(row["relative_error_percent"]), row["claim"].get<std::string>()});
    }
    return table(lines);
}

std::string histories_markdown(const Json& json) {
    std::string text = "# Slices, surfaces and time histories\n\nSize: " + json["size"].get<std::string>() + ". " +
                       machine_line(json["machine"]) +
                       ".\n\n![the paper's figures 4, 5, 7, 8, 9, 11, 12](histories.svg)\n\n" + histories_table(json);
    text += std::string("\n") + what_the_errors_are +
            "- *with singular vectors*: the same U and the same dual snapshots, compressed by a "
            "singular value decomposition, whose vectors have either sign, so that s >= 0 no longer says "
            "lambda >= 0.\n- The paper does not say which three points its figures 7 and 8 show; here "
            "(0.5, 0.5), (0.25, 0.25) and (0.7, 0.5). Parameters are the paper's: none is a candidate.\n";
    for (const Json& row : json["rows"])
        if (row.contains("singular_vectors_outcome"))
            text += "- Figure " + row["figures"].get<std::string>() +
                    ", singular vectors: " + row["singular_vectors_outcome"].get<std::string>() + ".\n";
    return text;
}

const Study& histories_study() {
    static const Study study =
        study_of_scenes("histories", "Figures 4, 5, 7, 8, 9, 11, 12: slices, time histories, surfaces",
                        Measured::errors, run_histories, histories_table, histories_markdown);
    return study;
}

}  // namespace tact::bench
