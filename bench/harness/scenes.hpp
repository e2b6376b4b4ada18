// Every scene by name, with the grid and the times it is usually run at.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "../../lib/problem/contact_family.hpp"
#include "../../lib/scenes/mesh.hpp"

namespace tact::bench {

/// The exact motion at one time, at the nodes of the scene's mesh. One lambda may stand for the sum over all rows.
struct ExactState {
    Vector u;
    Vector v;  ///< empty unless second order in time
    Vector lambda;
};

struct StudyScene {
    std::string name = {};
    Index n = 0;  ///< nodes a side, or elements
    std::shared_ptr<const ContactFamily> family = {};
    Mesh mesh = {};
    double dt = 0;                                   ///< 0: static
    double t_end = 0;                                ///< 0: static
    std::function<ExactState(double t)> exact = {};  ///< empty where it is not known
    bool is_static() const { return dt == 0; }
};

/// The paper's three: static-obstacle, dynamic-obstacle, two-plates, on n x n nodes a body (n = 0: its 200 or 100).
/// Then those of time integration, with n elements or nodes. InputError that lists the names for another one.
StudyScene study_scene(std::string_view name, Index n = 0);
std::vector<std::string> study_scene_names();

}  // namespace tact::bench
