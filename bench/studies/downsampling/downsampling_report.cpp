// The down-sampling study's table and page.
#include <algorithm>

#include "../../harness/report.hpp"
#include "../../harness/timing.hpp"
#include "downsampling.hpp"

namespace tact::bench {
namespace {

bool of_one_basis_size(const Json& a, const Json& b) {
    return a["selection"] == b["selection"] && a["stride"] == b["stride"] && a["tolerance"] == b["tolerance"];
}

std::string claims_table(const Json& claims) {
    std::vector<std::vector<std::string>> lines{{"the paper's claim", "the paper", "figure"}};
    for (const Json& claim : claims)
        lines.push_back(
            {claim["claim"].get<std::string>(), claim["paper"].get<std::string>(), digits(claim["figure"])});
    return table(lines);
}

}  // namespace

std::string downsampling_table(const Json& json) {
    std::vector<std::vector<std::string>> lines{{"selection", "stride or tolerance", "snapshots", "share, %",
                                                 "with contact", "p", "least relative error in the norm, %", "median",
                                                 "largest", "median, squared, as the paper prints it, %"}};
    std::vector<Json> seen;
    for (const Json& row : json["rows"]) {
        if (std::ranges::any_of(seen, [&](const Json& other) { return of_one_basis_size(row, other); })) continue;
        seen.push_back(row);
        std::vector<double> errors, squares;
        std::vector<long> sizes;
        for (const Json& other : json["rows"])
            if (of_one_basis_size(row, other)) {
                squares.push_back(other["relative_error_percent"].get<double>());
                errors.push_back(norm_percent(squares.back()).get<double>());
                sizes.push_back(other["p"].get<long>());
            }
        const auto [least, most] = std::ranges::minmax(sizes);
        lines.push_back({row["selection"].get<std::string>(),
                         digits(row["stride"].is_null() ? row["tolerance"] : row["stride"]), row["snapshots"].dump(),
                         digits(row["share_percent"]), row["dual_snapshots"].dump(),
                         least == most ? std::to_string(least) : std::to_string(least) + "-" + std::to_string(most),
                         digits(*std::ranges::min_element(errors)), digits(median(errors)),
                         digits(*std::ranges::max_element(errors)), digits(median(squares))});
    }
    return table(lines) + "\n" + claims_table(json["claims"]);
}

std::string downsampling_markdown(const Json& json) {
    return "# Fewer snapshots in time\n\nSize: " + json["size"].get<std::string>() + ". " +
           machine_line(json["machine"]) +
           ".\n\n![error against the share of snapshots](downsampling.svg)\n\nTwo plates, the reduced run against "
           "the full "
           "one it was trained on. Each selection is asked for "
           "neighbouring p; a single one would tell little, because contact amplifies small changes of a basis.\n\n" +
           downsampling_table(json) + "\n" + what_the_errors_are +
           "- *every k-th step*: snapshots of u and of lambda at multiples of k; *all multipliers*: of u only, "
           "those of "
           "lambda at all steps.\n- *tolerance*: a snapshot is left out if it differs from the one kept last by less "
           "than this fraction of its norm; it takes many where the plates are fast.\n- *with contact*: the dual "
           "snapshots that are kept.\n";
}

const Study& downsampling_study() {
    static const Study study =
        study_of_scenes("downsampling", "Figure 13: reduced plates from fewer snapshots in time", Measured::errors,
                        run_downsampling, downsampling_table, downsampling_markdown);
    return study;
}

}  // namespace tact::bench
