// What studies of the paper's scenes take.
#pragma once

#include <string>
#include <vector>

#include "machine.hpp"

namespace tact::bench {

struct StudyOptions {
    bool small = false;
    std::vector<std::string> scenes = {};  ///< wanted; empty: all the study has
    bool wants(const std::string& scene) const;
};

/// InputError in the name of the study, listing its scenes, if another one is wanted.
void check_scenes(const std::string& study, const StudyOptions& options, const std::vector<std::string>& known);

}  // namespace tact::bench
