#include "duffing_membrane.hpp"

#include <cmath>
#include <string>

#include "../errors.hpp"
#include "membrane.hpp"

namespace tact {

Scene duffing_membrane(Index n, const DuffingMembraneData& data) {
    if (!(data.bed >= 0) || !std::isfinite(data.bed))
        throw InputError("duffing_membrane: bed is " + shown(data.bed) + ", expected >= 0");
    if (!(data.obstacle <= 0) || !std::isfinite(data.obstacle))
        throw InputError("duffing_membrane: obstacle is " + shown(data.obstacle) + ", expected <= 0");
    if (!std::isfinite(data.load))
        throw InputError("duffing_membrane: load is " + shown(data.load) + ", expected a finite number");
    const MembraneFamily family(n, Motion::dynamic);
    ContactProblem problem = family.at(0.5 * (family.lower() + family.upper()));
    const double h = 1.0 / static_cast<double>(n + 1), area = h * h;
    problem.c = Vector(Vector::Constant(n * n, data.obstacle));
    problem.f = Vector(Vector::Constant(n * n, data.load * area));
    const double k = data.bed * area;
    problem.r = InternalForce{[k](const ConstVectorRef& u, VectorRef out) { out = k * u.array().cube(); },
                              [k](const ConstVectorRef& u) { return Matrix::diagonal(3 * k * u.array().square()); },
                              [k](const ConstVectorRef& u) { return k / 4 * u.array().square().square().sum(); }};
    return {std::move(problem), family.mesh()};
}

}  // namespace tact
