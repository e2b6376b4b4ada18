// Where the unknowns of a scene lie in space: what turns u into values at points, pictures and files.
#pragma once

#include <vector>

#include "tact/lib/contact_problem.hpp"

namespace tact {

/// Bodies over the unit square, each with one scalar unknown at the n x n interior nodes of the same grid and fixed
/// (u = 0) on the boundary. Node (i, j) lies at ((i+1) h, (j+1) h), h = 1/(n+1), and is number i + n j of its body.
struct Mesh {
    struct Body {
        Index first = 0;       ///< its first unknown
        double elevation = 0;  ///< of its rest position; u is measured from there
    };
    Index n = 0;
    std::vector<Body> bodies;

    /// InputError unless n >= 3. Unknowns are numbered body after body.
    static Mesh unit_square(Index n, std::vector<double> elevations = {0});

    double h() const { return 1 / static_cast<double>(n + 1); }
    Index nodes() const { return n * n; }
    Index unknowns() const { return nodes() * static_cast<Index>(bodies.size()); }
    double coordinate(Index i) const { return static_cast<double>(i + 1) / static_cast<double>(n + 1); }
    double x(Index node) const { return coordinate(node % n); }
    double y(Index node) const { return coordinate(node / n); }
};

/// u of one body at (x, y) by bilinear interpolation, zero on the boundary. InputError outside the unit square, for
/// a body that is not there, or for a u of the wrong size.
double value_at(const Mesh& mesh, const ConstVectorRef& u, double x, double y, std::size_t body = 0);

/// A problem and where it lies in space.
struct Scene {
    ContactProblem problem;
    Mesh mesh;
};

}  // namespace tact
