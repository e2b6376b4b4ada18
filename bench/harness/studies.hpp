// Every study by name, and all of them in turn.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "machine.hpp"

namespace tact::bench {

struct StudySize {
    bool small = false;
    int repeats = 5;
};

/// What a study's numbers are, and so what may go on beside it.
enum class Measured {
    errors,        ///< no times: it may run beside those that measure CPU time
    cpu_time,      ///< of one thread: it shares its core with nothing
    elapsed_time,  ///< it has all processors to itself
};

/// What leaves NAME.json, NAME.md and NAME.svg.
struct Study {
    std::string name;
    Measured measured;
    std::function<Json(const StudySize&)> run;
    std::function<std::string(const Json&)> markdown;
};
/// In the order of the page.
const std::vector<Study>& studies();

struct AllOptions {
    StudySize size;
    std::filesystem::path out = "results";
    bool force = false;                  ///< else studies of that size whose files are there are kept
    std::vector<std::string> only = {};  ///< names; empty: all
};

/// Runs one study after the other and writes each as soon as it is there, "study_seconds" (wall) added; beside them, on a
/// processor of their own where there is one, those without times (see Beside). A study that fails is said on standard error
/// and the next one runs; returns how many failed. InputError for a name that is none; Interrupted.
int run_all(const AllOptions& options, const std::vector<Study>& all = studies());

/// index.html from the studies in a folder: one page, figures and tables inline. NumericalError if it cannot be made.
void write_page(const std::filesystem::path& results);

}  // namespace tact::bench
