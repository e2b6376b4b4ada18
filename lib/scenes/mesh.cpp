#include "tact/lib/scenes/mesh.hpp"

#include <algorithm>
#include <string>

#include "tact/lib/errors.hpp"

namespace tact {

Mesh Mesh::unit_square(Index n, std::vector<double> elevations) {
    if (n < 3) throw InputError("Mesh: n is " + std::to_string(n) + ", expected at least 3 interior nodes a side");
    if (elevations.empty()) throw InputError("Mesh: elevations is empty, expected one a body");
    Mesh mesh;
    mesh.n = n;
    for (const double elevation : elevations) mesh.bodies.push_back({mesh.unknowns(), elevation});
    return mesh;
}

double value_at(const Mesh& mesh, const ConstVectorRef& u, double x, double y, std::size_t body) {
    if (u.size() != mesh.unknowns())
        throw InputError("value_at: u is " + std::to_string(u.size()) + "x1, expected " +
                         std::to_string(mesh.unknowns()) + "x1");
    if (body >= mesh.bodies.size())
        throw InputError("value_at: body is " + std::to_string(body) + ", expected below " +
                         std::to_string(mesh.bodies.size()));
    if (!(x >= 0 && x <= 1 && y >= 0 && y <= 1))
        throw InputError("value_at: point is (" + std::to_string(x) + ", " + std::to_string(y) +
                         "), expected inside the unit square");
    // Cell (i, j) has its lower left corner at (i h, j h), on the boundary for i = 0 or j = 0.
    const double cells = static_cast<double>(mesh.n + 1);
    const Index i = std::min(static_cast<Index>(x * cells), mesh.n);
    const Index j = std::min(static_cast<Index>(y * cells), mesh.n);
    const double s = x * cells - static_cast<double>(i);
    const double t = y * cells - static_cast<double>(j);
    const auto corner = [&](Index column, Index row) {
        const bool inside = column >= 1 && column <= mesh.n && row >= 1 && row <= mesh.n;
        return inside ? u[mesh.bodies[body].first + column - 1 + mesh.n * (row - 1)] : 0.0;
    };
    return (1 - t) * ((1 - s) * corner(i, j) + s * corner(i + 1, j)) +
           t * ((1 - s) * corner(i, j + 1) + s * corner(i + 1, j + 1));
}

}  // namespace tact
