// The training study's table and page.
#include "../../harness/report.hpp"
#include "training_study.hpp"

namespace tact::bench {
namespace {

std::string by_iteration(const Json& json) {
    std::vector<std::vector<std::string>> lines{{"scene", "full solves", "p / p_lambda", "snapshots", "full runs",
                                                 "POD", "dual bases", "projection", "candidates"}};
    for (const Json& row : json["rows"])
        lines.push_back({row["scene"].get<std::string>(), row["full_solves"].dump(),
                         row["p"].dump() + " / " + row["p_lambda"].dump(),
                         row["snapshots"].dump() + " / " + row["dual_snapshots"].dump(),
                         with_unit(row["full_run_seconds"]), with_unit(row["pod_seconds"]),
                         with_unit(row["dual_basis_seconds"]), with_unit(row["projection_seconds"]),
                         with_unit(row["candidates_seconds"])});
    return table(lines);
}

std::string peaks(const Json& scene) {
    std::string text;
    for (const auto& [part, megabytes] : scene["peak_megabytes"].items()) {
        std::string name = part == "pod" ? "POD" : part;
        if (const auto place = name.find('_'); place != std::string::npos) name[place] = ' ';
        text += (text.empty() ? "" : ", ") + name + " " + digits(megabytes);
    }
    return text;
}

std::string by_scene(const Json& json) {
    std::vector<std::vector<std::string>> lines{{"scene"},
                                                {"full solves"},
                                                {"candidates"},
                                                {"training, CPU"},
                                                {"elapsed"},
                                                {"two threads, CPU"},
                                                {"elapsed"},
                                                {"same bits"},
                                                {"full run"},
                                                {"reduced run"},
                                                {"pays after queries"},
                                                {"peak memory, MB"}};
    for (const Json& scene : json["scenes"]) {
        std::size_t k = 0;
        const auto put = [&](const std::string& cell) { lines[k++].push_back(cell); };
        put(scene["scene"].get<std::string>());
        put(scene["full_solves"].dump());
        put(scene["candidates"].dump());
        put(with_unit(scene["training_seconds"]));
        put(with_unit(scene["training_elapsed_seconds"]));
        put(with_unit(scene["two_threads_seconds"]));
        put(with_unit(scene["two_threads_elapsed_seconds"]));
        put(scene["two_threads_same_bits"].get<bool>() ? "yes" : "no");
        put(with_unit(scene["full_seconds"]));
        put(with_unit(scene["reduced_seconds"]));
        put(digits(scene["break_even_queries"]));
        put(peaks(scene));
    }
    return table(lines);
}

}  // namespace

std::string training_table(const Json& json) { return by_scene(json); }

std::string training_markdown(const Json& json) {
    return "# What training costs\n\nSize: " + json["size"].get<std::string>() + ". " +
           machine_line(json["machine"]) + ".\n\n![CPU seconds by part](training.svg)\n\n" + by_scene(json) +
           "\n- *pays after*: training's CPU time over what one reduced run saves against a warm full one.\n- "
           "*elapsed* "
           "depends on what else the machine does; CPU times do not. Two threads share the candidates only.\n- *peak "
           "memory*: the most the process holds in that part beyond what it held before training; POD goes on during "
           "the "
           "full run.\n\nCPU seconds up to each full solve:\n\n" +
           by_iteration(json);
}

const Study& training_study() {
    static const Study study =
        study_of_scenes("training", "What training costs by part, and when it has paid", Measured::elapsed_time,
                        run_training, training_table, training_markdown);
    return study;
}

}  // namespace tact::bench
