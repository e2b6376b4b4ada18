// Where the unknowns of a scene lie in space: what turns u into values at points, pictures and files.
#pragma once

#include <vector>

#include "../problem/contact_problem.hpp"

namespace tact {

/// Bodies with one scalar unknown a node, u measured from the body's rest position and zero on fixed boundaries. Either
/// all over the unit square, at the n x n interior nodes of the same grid with u = 0 on the boundary: node (i, j) lies
/// at ((i+1) h, (j+1) h), h = 1/(n+1), and is number i + n j of its body. Or all on the line (n = 0), each with nodes
/// of its own.
struct Mesh {
    struct Body {
        Index first = 0;             ///< its first unknown
        double elevation = 0;        ///< of its rest position
        Vector line = {};            ///< ascending coordinates of its unknowns; empty over the unit square
        double left = 0, right = 0;  ///< its ends on the line; u = 0 at an end where no unknown lies
    };
    Index n = 0;
    std::vector<Body> bodies;

    /// InputError unless n >= 3. Unknowns are numbered body after body.
    static Mesh unit_square(Index n, std::vector<double> elevations = {0});
    /// No body yet: `add_line` appends them.
    static Mesh on_line() { return {}; }
    /// A body from left to right in equal elements, its nodes numbered after the unknowns there are; a fixed end is a
    /// node without an unknown. InputError unless left <= right, elements >= 0, and an unknown remains.
    enum class Ends { free, right_fixed, fixed };
    void add_line(double left, double right, Index elements, Ends ends = Ends::free);

    bool square() const { return n > 0; }
    Index unknowns() const;

    /// Over the unit square only.
    double h() const { return 1 / static_cast<double>(n + 1); }
    Index nodes() const { return n * n; }
    double coordinate(Index i) const { return static_cast<double>(i + 1) / static_cast<double>(n + 1); }
    double x(Index node) const { return coordinate(node % n); }
    double y(Index node) const { return coordinate(node / n); }
};

/// u of one body at (x, y) by bilinear interpolation, zero on the boundary. InputError outside the unit square, for
/// a body that is not there, for bodies on the line, or for a u of the wrong size.
double value_at(const Mesh& mesh, const ConstVectorRef& u, double x, double y, std::size_t body = 0);
/// u of one body on the line at x by linear interpolation, zero at a fixed end. InputError as above.
double value_on_line(const Mesh& mesh, const ConstVectorRef& u, double x, std::size_t body = 0);

/// A problem and where it lies in space.
struct Scene {
    ContactProblem problem;
    Mesh mesh;
};

}  // namespace tact
