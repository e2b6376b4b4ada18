#include "all.hpp"

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <chrono>
#include <fstream>
#include <iostream>
#include <memory>
#include <optional>

#include "../../lib/errors.hpp"
#include "../harness/beside.hpp"
#include "../harness/interrupt.hpp"
#include "../harness/progress.hpp"
#include "../harness/report.hpp"
#include "report.hpp"

namespace tact::bench {
namespace {

/// Whether the three files of a study of that size are there.
bool finished(const Study& study, const AllOptions& options) {
    for (const char* kind : {".md", ".svg"})
        if (!std::filesystem::exists(options.out / (study.name + kind))) return false;
    std::ifstream file(options.out / (study.name + ".json"));
    const Json json = Json::parse(file, nullptr, false);
    return json.is_object() && json.value("size", "") == (options.small ? "small" : "full");
}

std::string names_of(const std::vector<const Study*>& list) {
    std::string names;
    for (const Study* study : list) names += (names.empty() ? "" : ", ") + study->name;
    return names;
}

std::vector<const Study*> wanted_of(const AllOptions& options, const std::vector<Study>& all) {
    std::vector<const Study*> known, wanted;
    for (const Study& study : all) {
        known.push_back(&study);
        if (options.only.empty() || std::ranges::find(options.only, study.name) != options.only.end())
            wanted.push_back(&study);
    }
    if (wanted.size() < options.only.size() || wanted.empty())
        throw InputError("all: --only names a study that is none of " + names_of(known));
    return wanted;
}

/// A line of its own, also while another process shows a bar.
void say(std::ostream& out, const std::string& line) {
    if (isatty(STDERR_FILENO)) std::cerr << "\r\033[K";
    out << line << std::flush;
}

/// Whether it is written; else why not has been said.
bool run_one(const Study& study, const AllOptions& options) {
    const auto start = std::chrono::steady_clock::now();
    try {
        Json json = study.run({.small = options.small, .repeats = options.repeats, .by_all = true});
        const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        json["study_seconds"] = seconds;
        write_study(options.out, study.name, json, study.markdown(json));
        say(std::cout, study.name + ": " + duration(seconds) + "\n");
        return true;
    } catch (const Interrupted&) {
        throw;
    } catch (const std::exception& error) {
        say(std::cerr, "tact-bench: " + study.name + ": " + error.what() + "\n");
        return false;
    }
}

/// How many were not written.
int run_beside(const std::vector<const Study*>& studies, const AllOptions& options, std::atomic<int>& done) {
    int written = 0;
    try {
        for (const Study* study : studies) {
            written += run_one(*study, options) ? 1 : 0;
            ++done;
        }
    } catch (const Interrupted&) {}
    return static_cast<int>(studies.size()) - written;
}

}  // namespace

int run_all(const AllOptions& options, const std::vector<Study>& all) {
    const std::vector<const Study*> wanted = wanted_of(options, all);
    std::vector<const Study*> beside, here;
    for (const Study* study : wanted) {
        if (!options.force && finished(*study, options))
            say(std::cout, study->name + ": kept\n");
        else
            (study->measured == Measured::errors && Beside::possible() ? beside : here).push_back(study);
    }
    if (here.empty()) here.swap(beside);  // with bars
    int failed = 0;
    std::optional<Beside> others;
    if (!beside.empty()) others.emplace([&](std::atomic<int>& done) { return run_beside(beside, options, done); });
    const auto wait_for_others = [&] {
        if (!others) return;
        Progress progress(names_of(beside), static_cast<double>(beside.size()));
        const int code = others->wait(progress);
        failed += code >= 0 ? code : static_cast<int>(beside.size()) - others->done();
        if (code < 0)
            say(std::cerr, "tact-bench: " + names_of(beside) + ": ended by signal " + std::to_string(-code) + "\n");
        others.reset();
    };
    const std::size_t kept = wanted.size() - here.size() - beside.size();
    for (std::size_t k = 0; k < here.size(); ++k) {
        if (here[k]->measured == Measured::elapsed_time) wait_for_others();
        const std::size_t number = kept + k + 1 + (others ? static_cast<std::size_t>(others->done()) : beside.size());
        const ProgressPart part(here[k]->name + " (" + std::to_string(number) + " of " +
                                std::to_string(wanted.size()) + ")");
        failed += run_one(*here[k], options) ? 0 : 1;
    }
    wait_for_others();
    return failed;
}

Command all_command() {
    return {"all", "Every study in turn, those that are there kept, and their page",
            [](CLI::App& command) -> std::function<int()> {
                struct Asked {
                    AllOptions options;
                    std::string out = "results";
                };
                const auto asked = std::make_shared<Asked>();
                AllOptions& options = asked->options;
                add_size_option(command, Study().sizes, options.small);
                add_repeats_option(command, options.repeats);
                add_out_option(command, asked->out);
                command.add_flag("--force", options.force, "Run finished studies again");
                std::string names;
                for (const Study& study : studies()) names += (names.empty() ? "" : ",") + study.name;
                command.add_option("--only", options.only, names + " (all)")->delimiter(',');
                return [asked] {
                    asked->options.out = asked->out;
                    const int failed = run_all(asked->options);
                    write_page(asked->out);
                    std::cout << "written: " << (asked->options.out / "index.html").string() << "\n";
                    return failed > 0 ? 1 : 0;
                };
            }};
}

}  // namespace tact::bench
