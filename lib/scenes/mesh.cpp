#include "mesh.hpp"

#include <algorithm>
#include <string>

#include "../errors.hpp"

namespace tact {

Mesh Mesh::unit_square(Index n, std::vector<double> elevations) {
    if (n < 3) throw InputError("Mesh: n is " + std::to_string(n) + ", expected at least 3 interior nodes a side");
    if (elevations.empty()) throw InputError("Mesh: elevations is empty, expected one a body");
    Mesh mesh;
    mesh.n = n;
    for (const double elevation : elevations) mesh.bodies.push_back({mesh.unknowns(), elevation});
    return mesh;
}

void Mesh::add_line(double left, double right, Index elements, Ends ends) {
    const Index fixed_left = ends == Ends::fixed, fixed_right = ends != Ends::free;
    const Index count = elements + 1 - fixed_left - fixed_right;
    if (square()) throw InputError("Mesh: its bodies lie over the unit square, expected none or bodies on the line");
    if (elements < 0 || count < 1)
        throw InputError("Mesh: elements is " + std::to_string(elements) + ", expected enough for a free node");
    if (!(elements == 0 ? left == right : left < right))
        throw InputError("Mesh: a body from " + shown(left) + " to " + shown(right) +
                         ", expected its left end first");
    Body body{unknowns(), 0, Vector(count), left, right};
    for (Index i = 0; i < count; ++i) {
        const Index node = i + fixed_left;
        const double s = elements == 0 ? 0 : static_cast<double>(node) / static_cast<double>(elements);
        body.line[i] = (1 - s) * left + s * right;
    }
    bodies.push_back(std::move(body));
}

Index Mesh::unknowns() const {
    if (square()) return nodes() * static_cast<Index>(bodies.size());
    return bodies.empty() ? 0 : bodies.back().first + bodies.back().line.size();
}

namespace {

void check_values(const char* name, const Mesh& mesh, const ConstVectorRef& u, std::size_t body) {
    if (u.size() != mesh.unknowns())
        throw InputError(std::string(name) + ": u is " + std::to_string(u.size()) + "x1, expected " +
                         std::to_string(mesh.unknowns()) + "x1");
    if (body >= mesh.bodies.size())
        throw InputError(std::string(name) + ": body is " + std::to_string(body) + ", expected below " +
                         std::to_string(mesh.bodies.size()));
}

}  // namespace

double value_at(const Mesh& mesh, const ConstVectorRef& u, double x, double y, std::size_t body) {
    check_values("value_at", mesh, u, body);
    if (!mesh.square()) throw InputError("value_at: the bodies lie on the line, expected them over the unit square");
    if (!(x >= 0 && x <= 1 && y >= 0 && y <= 1))
        throw InputError("value_at: point is (" + shown(x) + ", " + shown(y) + "), expected inside the unit square");
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

double value_on_line(const Mesh& mesh, const ConstVectorRef& u, double x, std::size_t body) {
    check_values("value_on_line", mesh, u, body);
    const Mesh::Body& b = mesh.bodies[body];
    if (mesh.square()) throw InputError("value_on_line: the bodies lie over the unit square, expected on the line");
    if (!(x >= b.left && x <= b.right))
        throw InputError("value_on_line: x is " + shown(x) + ", expected from " + shown(b.left) + " to " +
                         shown(b.right));
    // Between node k - 1 and node k; an end without an unknown is a node of its own with the value zero.
    const Index count = b.line.size();
    const Index k = std::lower_bound(b.line.data(), b.line.data() + count, x) - b.line.data();
    if (k < count && b.line[k] == x) return u[b.first + k];
    const double x0 = k == 0 ? b.left : b.line[k - 1], u0 = k == 0 ? 0 : u[b.first + k - 1];
    const double x1 = k == count ? b.right : b.line[k], u1 = k == count ? 0 : u[b.first + k];
    return u0 + (u1 - u0) * (x - x0) / (x1 - x0);
}

}  // namespace tact
