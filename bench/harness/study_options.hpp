// What studies of scenes take.
#pragma once

#include <string>
#include <vector>

#include "study.hpp"

namespace tact::bench {

struct StudyOptions {
    bool small = false;
    std::vector<std::string> scenes = {};  ///< wanted; empty: all the study has
    bool wants(const std::string& scene) const;
};

/// InputError in the name of the study, listing its scenes, if another one is wanted.
void check_scenes(const std::string& study, const StudyOptions& options, const std::vector<std::string>& known);

/// The --scenes of a study; `about` lists them.
StudyOption scenes_option(std::string about = "static-obstacle,dynamic-obstacle,two-plates (all)");

/// A study with nothing to choose but its size and scenes.
Study study_of_scenes(std::string name, std::string about, Measured measured, Json (*run)(const StudyOptions&),
                      std::string (*table)(const Json&), std::string (*markdown)(const Json&));

}  // namespace tact::bench
