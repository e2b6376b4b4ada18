#include "study_options.hpp"

#include <algorithm>
#include <utility>

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

StudyOption scenes_option(std::string about) { return {.name = "scenes", .about = std::move(about)}; }

Study study_of_scenes(std::string name, std::string about, Measured measured, Json (*run)(const StudyOptions&),
                      std::string (*table)(const Json&), std::string (*markdown)(const Json&)) {
    return {.name = std::move(name),
            .about = std::move(about),
            .measured = measured,
            .options = {scenes_option("Those wanted of the study's scenes (all)")},
            .run =
                [run](const StudyArguments& asked) {
                    return run({asked.small, asked.list("scenes")});
                },
            .table = table,
            .markdown = markdown};
}

}  // namespace tact::bench
