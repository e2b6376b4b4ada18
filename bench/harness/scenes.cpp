#include "scenes.hpp"

#include <utility>

#include "../../lib/errors.hpp"
#include "../../lib/problem/mass_redistribution.hpp"
#include "../../lib/scenes/american_put.hpp"
#include "../../lib/scenes/bar.hpp"
#include "../../lib/scenes/mass_on_stop.hpp"
#include "../../lib/scenes/membrane.hpp"
#include "../../lib/scenes/plates.hpp"
#include "../../lib/scenes/pressed_membrane.hpp"
#include "../../lib/scenes/string.hpp"

namespace tact::bench {
namespace {

StudyScene single(Scene scene, double dt, double t_end) {
    return {.family = std::make_shared<SingleProblem>(std::move(scene.problem)),
            .mesh = std::move(scene.mesh),
            .dt = dt,
            .t_end = t_end};
}

StudyScene obstacle(Index n, Motion motion) {
    const auto family = std::make_shared<MembraneFamily>(n, motion);
    const bool moves = motion == Motion::dynamic;
    return {.family = family, .mesh = family->mesh(), .dt = moves ? 0.005 : 0, .t_end = moves ? 2.0 : 0.0};
}

Scene redistributed(Scene scene) {
    scene.problem = redistribute_mass(scene.problem);
    return scene;
}

/// `at(x, body)` is the BarState at a node, `force` the contact force of the only row.
template <class At> ExactState at_nodes(const Mesh& mesh, double force, At at) {
    ExactState exact{Vector(mesh.unknowns()), Vector(mesh.unknowns()), Vector::Constant(1, force)};
    for (std::size_t body = 0; body < mesh.bodies.size(); ++body)
        for (Index i = 0; i < mesh.bodies[body].line.size(); ++i) {
            const BarState state = at(mesh.bodies[body].line[i], body);
            exact.u[mesh.bodies[body].first + i] = state.u;
            exact.v[mesh.bodies[body].first + i] = state.v;
        }
    return exact;
}

StudyScene impact(Scene bar) {
    StudyScene scene = single(std::move(bar), 1e-3, 1.5);
    scene.exact = [mesh = scene.mesh](double t) {
        return at_nodes(mesh, bar_impact_force({}, t),
                        [t](double x, std::size_t) { return bar_impact_exact({}, x, t); });
    };
    return scene;
}

StudyScene bouncing(Scene bar) {
    StudyScene scene = single(std::move(bar), 1e-3, 6);
    scene.exact = [mesh = scene.mesh](double t) {
        return at_nodes(mesh, bouncing_bar_force(t), [t](double x, std::size_t) { return bouncing_bar_exact(x, t); });
    };
    return scene;
}

StudyScene collision(TwoBarsData data, Index n) {
    data.left.elements = data.right.elements = n;
    return single(two_bars(data), 1e-3, 2);
}

StudyScene equal_bars(Index n) {
    StudyScene scene = collision({}, n);
    scene.exact = [mesh = scene.mesh](double t) {
        return at_nodes(mesh, two_bars_force({}, t),
                        [t](double x, std::size_t body) { return two_bars_exact({}, x, t, body); });
    };
    return scene;
}

/// The exact trajectory of an elastic impact; lambda is unknown at the impact itself and zero elsewhere.
StudyScene bounce(const MassOnStopData& data, double t_end) {
    StudyScene scene = single(mass_on_stop(data), 1e-3, t_end);
    scene.exact = [data](double t) {
        const BounceState state = bouncing_ball(data, 1, t);
        return ExactState{Vector::Constant(1, state.u), Vector::Constant(1, state.v), Vector::Zero(1)};
    };
    return scene;
}

StudyScene plucked(Index n) {
    StudyScene scene = single(plucked_string(n), 1e-3, 3);
    scene.exact = [mesh = scene.mesh](double t) {
        return at_nodes(mesh, plucked_string_force({}, t),
                        [t](double x, std::size_t) { return plucked_string_exact({}, x, t); });
    };
    return scene;
}

StudyScene draped(Index n) { return single(draped_string(n, {.damping = 0.5}), 1e-3, 4); }
StudyScene draped_at_rest(Index n) {
    StudyScene scene = single(draped_string(n, {}, Motion::none), 0, 0);
    scene.exact = [line = scene.mesh.bodies[0].line](double) {
        return ExactState{line.unaryExpr([](double x) { return draped_string_rest({}, x); }), Vector(),
                          Vector::Ones(1)};  // of all rows together: the weight
    };
    return scene;
}

struct Entry {
    std::string name;
    Index n;  ///< the usual one
    std::function<StudyScene(Index n)> make;
};

const std::vector<Entry>& entries() {
    static const std::vector<Entry> all{
        {"static-obstacle", 200, [](Index n) { return obstacle(n, Motion::none); }},
        {"dynamic-obstacle", 200, [](Index n) { return obstacle(n, Motion::dynamic); }},
        {"two-plates", 100, [](Index n) { return single(two_plates(n), 2e-4, 0.4); }},
        {"mass-on-stop", 1, [](Index) { return bounce({}, 10); }},
        {"mass-on-spring", 1, [](Index) { return bounce({.gravity = 0, .stiffness = 4}, 10); }},
        {"bar-impact", 100, [](Index n) { return impact(bar_impact(n)); }},
        {"bar-impact-consistent", 100, [](Index n) { return impact(bar_impact(n, {}, Mass::consistent)); }},
        {"bar-impact-redistributed", 100, [](Index n) { return impact(redistributed(bar_impact(n))); }},
        {"falling-bar", 100, [](Index n) { return single(bar_impact(n, {.velocity = 0, .gravity = 10}), 1e-3, 3); }},
        {"bouncing-bar", 100, [](Index n) { return bouncing(bouncing_bar(n)); }},
        {"bouncing-bar-redistributed", 100, [](Index n) { return bouncing(redistributed(bouncing_bar(n))); }},
        {"two-bars", 100, equal_bars},
        {"light-bar-on-heavy-bar", 100, [](Index n) { return collision({.right = {.density = 1e6}}, n); }},
        {"soft-bar-on-stiff-bar", 100, [](Index n) { return collision({.right = {.modulus = 900e9}}, n); }},
        {"plucked-string", 100, plucked},
        {"american-put", 300, [](Index n) { return single(american_put(n), 5e-3, 1); }},
        {"draped-string", 100, draped},
        {"draped-string-at-rest", 100, draped_at_rest},
        {"pressed-membrane", 60, [](Index n) { return single(pressed_membrane(n), 1e-2, 1); }},
    };
    return all;
}

}  // namespace

StudyScene study_scene(std::string_view name, Index n) {
    for (const Entry& entry : entries()) {
        if (entry.name != name) continue;
        StudyScene scene = entry.make(n == 0 ? entry.n : n);
        scene.name = name;
        scene.n = n == 0 ? entry.n : n;
        return scene;
    }
    std::string names;
    for (const std::string& each : study_scene_names()) names += (names.empty() ? "" : ", ") + each;
    throw InputError("study_scene: name is " + std::string(name) + ", expected one of " + names);
}

std::vector<std::string> study_scene_names() {
    std::vector<std::string> names;
    for (const Entry& entry : entries()) names.push_back(entry.name);
    return names;
}

}  // namespace tact::bench
