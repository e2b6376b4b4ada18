// The paper's three scenes by name, with the paper's grid and times.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "tact/lib/contact_family.hpp"
#include "tact/lib/scenes/mesh.hpp"

namespace tact::bench {

struct StudyScene {
    std::string name;
    std::shared_ptr<const ContactFamily> family;
    Mesh mesh;
    double dt = 0;     ///< 0: static
    double t_end = 0;  ///< 0: static
    bool is_static() const { return dt == 0; }
};

/// "static-obstacle", "dynamic-obstacle" or "two-plates" on n x n nodes a body; n = 0: the paper's 200 or 100.
/// InputError for another name.
StudyScene study_scene(std::string_view name, Index n = 0);

}  // namespace tact::bench
