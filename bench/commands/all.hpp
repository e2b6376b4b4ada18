// `tact-bench all`: every study in turn.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "../studies/studies.hpp"
#include "command.hpp"

namespace tact::bench {

struct AllOptions {
    bool small = false;
    int repeats = 5;
    std::filesystem::path out = "results";
    bool force = false;                  ///< else studies of that size whose files are there are kept
    std::vector<std::string> only = {};  ///< names; empty: all
};

/// Runs one study after the other and writes each as soon as it is there, "study_seconds" (wall) added; beside them, on a
/// processor of their own where there is one, those without times (see Beside). A study that fails is said on standard error
/// and the next one runs; returns how many failed. InputError for a name that is none; Interrupted.
int run_all(const AllOptions& options, const std::vector<Study>& all = studies());

Command all_command();

}  // namespace tact::bench
