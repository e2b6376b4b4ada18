#include "study_options.hpp"

#include <algorithm>

#include "../../lib/errors.hpp"

namespace tact::bench {

bool StudyOptions::wants(const std::string& scene) const {
    return scenes.empty() || std::ranges::find(scenes, scene) != scenes.end();
}

void check_scenes(const std::string& study, const StudyOptions& options, const std::vector<std::string>& known) {
    std::string names;
    for (const std::string& name : known) names += (names.empty() ? "" : ", ") + name;
    for (const std::string& scene : options.scenes)
        if (std::ranges::find(known, scene) == known.end())
            throw InputError(study + ": scene is " + scene + ", expected one of " + names);
}

}  // namespace tact::bench
