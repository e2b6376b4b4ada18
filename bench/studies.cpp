#include "tact/bench/studies.hpp"

#include <algorithm>
#include <chrono>
#include <fstream>
#include <iostream>

#include "tact/bench/bases.hpp"
#include "tact/bench/downsampling.hpp"
#include "tact/bench/greedy_study.hpp"
#include "tact/bench/growth_study.hpp"
#include "tact/bench/histories.hpp"
#include "tact/bench/interrupt.hpp"
#include "tact/bench/omission.hpp"
#include "tact/bench/online.hpp"
#include "tact/bench/progress.hpp"
#include "tact/bench/report.hpp"
#include "tact/bench/solvers.hpp"
#include "tact/bench/speedup.hpp"
#include "tact/bench/stability.hpp"
#include "tact/bench/tradeoff.hpp"
#include "tact/bench/training_study.hpp"
#include "tact/bench/work_precision.hpp"
#include "tact/lib/errors.hpp"

namespace tact::bench {

namespace {

/// Of a study with nothing to choose but its size and scenes.
template <Json (*run)(const StudyOptions&)> Json plain(const StudySize& size) { return run({size.small, {}}); }

}  // namespace

const std::vector<Study>& studies() {
    static const std::vector<Study> all{
        {"speedup", [](const StudySize& size) { return run_speedup({.small = size.small, .repeats = size.repeats}); },
         speedup_markdown},
        {"solvers",
         [](const StudySize& size) {
             return run_solvers({.small = size.small, .repeats = std::min(size.repeats, 3), .peers = true});
         },
         solvers_markdown},
        {"work-precision",
         [](const StudySize& size) {
             return run_work_precision({.small = size.small, .repeats = std::min(size.repeats, 3)});
         },
         work_precision_markdown},
        {"stability", [](const StudySize& size) { return run_stability({.small = size.small}); }, stability_markdown},
        {"bases",
         [](const StudySize& size) { return run_bases({.small = size.small, .repeats = std::min(size.repeats, 3)}); },
         bases_markdown},
        {"tradeoff", plain<run_tradeoff>, tradeoff_markdown},
        {"online", plain<run_online>, online_markdown},
        {"omission", plain<run_omission>, omission_markdown},
        {"growth", plain<run_growth_study>, growth_markdown},
        {"greedy", plain<run_greedy>, greedy_markdown},
        {"histories", plain<run_histories>, histories_markdown},
        {"training", plain<run_training>, training_markdown},
        {"downsampling", plain<run_downsampling>, downsampling_markdown},
    };
    return all;
}

namespace {

/// Whether the three files of a study of that size are there.
bool finished(const Study& study, const AllOptions& options) {
    for (const char* kind : {".md", ".svg"})
        if (!std::filesystem::exists(options.out / (study.name + kind))) return false;
    std::ifstream file(options.out / (study.name + ".json"));
    const Json json = Json::parse(file, nullptr, false);
    return json.is_object() && json.value("size", "") == (options.size.small ? "small" : "full");
}

}  // namespace

int run_all(const AllOptions& options) {
    std::vector<const Study*> wanted;
    for (const Study& study : studies())
        if (options.only.empty() || std::ranges::find(options.only, study.name) != options.only.end())
            wanted.push_back(&study);
    if (wanted.size() < options.only.size() || wanted.empty()) {
        std::string names;
        for (const Study& study : studies()) names += (names.empty() ? "" : ", ") + study.name;
        throw InputError("all: --only names a study that is none of " + names);
    }
    int failed = 0;
    for (std::size_t k = 0; k < wanted.size(); ++k) {
        const Study& study = *wanted[k];
        if (!options.force && finished(study, options)) {
            std::cout << study.name << ": kept\n" << std::flush;
            continue;
        }
        const ProgressPart part(study.name + " (" + std::to_string(k + 1) + " of " + std::to_string(wanted.size()) +
                                ")");
        const auto start = std::chrono::steady_clock::now();
        try {
            Json json = study.run(options.size);
            const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
            json["study_seconds"] = seconds;
            write_study(options.out, study.name, json, study.markdown(json));
            std::cout << study.name << ": " << duration(seconds) << "\n" << std::flush;
        } catch (const Interrupted&) {
            throw;
        } catch (const std::exception& error) {
            ++failed;
            std::cerr << "tact-bench: " << study.name << ": " << error.what() << "\n";
        }
    }
    return failed;
}

void write_page(const std::filesystem::path& results) {
    draw("index", results, results / "index.html", "needs python3; the studies are complete");
}

}  // namespace tact::bench
