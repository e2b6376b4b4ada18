#include "tact/bench/scenes.hpp"

#include "tact/lib/errors.hpp"
#include "tact/lib/scenes/membrane.hpp"
#include "tact/lib/scenes/plates.hpp"

namespace tact::bench {

StudyScene study_scene(std::string_view name, Index n) {
    StudyScene scene;
    scene.name = name;
    if (name == "static-obstacle" || name == "dynamic-obstacle") {
        const bool moves = name == "dynamic-obstacle";
        const auto family =
            std::make_shared<MembraneFamily>(n == 0 ? 200 : n, moves ? Motion::dynamic : Motion::none);
        scene.family = family;
        scene.mesh = family->mesh();
        if (moves) {
            scene.dt = 0.005;
            scene.t_end = 2;
        }
        return scene;
    }
    if (name == "two-plates") {
        Scene plates = two_plates(n == 0 ? 100 : n);
        scene.family = std::make_shared<SingleProblem>(std::move(plates.problem));
        scene.mesh = std::move(plates.mesh);
        scene.dt = 2e-4;
        scene.t_end = 0.4;
        return scene;
    }
    throw InputError("study_scene: name is " + scene.name +
                     ", expected static-obstacle, dynamic-obstacle or two-plates");
}

}  // namespace tact::bench
