// A membrane over an obstacle with two parameters, at rest or in motion.
#pragma once

#include "../problem/contact_family.hpp"
#include "mesh.hpp"

namespace tact {

enum class Motion { none, dynamic };

/// The unit square membrane, fixed at its edges, under the load -10, above the obstacle
///   g = -1 + 0.4 exp(-200 ((x - gamma1)^2 + (y - .5)^2)) + gamma2 exp(-355.56 ((x - .7)^2 + (y - .5)^2)).
///
/// Static: -lap u = -10 + lambda; dynamic: u_tt = lap u - 10 + lambda, at rest at first; u >= g on every node.
/// Five-point stencil on n x n interior nodes in finite element scaling: K = (4, -1, -1, -1, -1), M = h^2, f = -10 h^2,
/// so that lambda is a nodal force. B is the identity. gamma1 in [.3, .6], gamma2 in [.2, .6]; other finite values are
/// answered too. The problems of all gammas share M, K and B.
/// (Balajewicz, Amsallem, Farhat, eqs. 18 with its sign put right, 19, 20.)
class MembraneFamily final : public ContactFamily {
public:
    /// InputError unless n >= 3.
    explicit MembraneFamily(Index n, Motion motion = Motion::none);

    std::vector<std::string> names() const override { return {"gamma1", "gamma2"}; }
    Parameter lower() const override { return Eigen::Vector2d(0.3, 0.2); }
    Parameter upper() const override { return Eigen::Vector2d(0.6, 0.6); }

    /// InputError unless gamma holds two finite numbers.
    ContactProblem at(const Parameter& gamma) const override;
    /// One vectorised exponential a row: what of g does not depend on gamma is tabulated.
    void gap(const Parameter& gamma, std::span<const Index> rows, VectorRef out) const override;

    const Mesh& mesh() const { return mesh_; }

private:
    static constexpr Index block_ = 64;
    void check(const Parameter& gamma) const;
    template <class RowAt> void fill(const Parameter& gamma, Index count, RowAt row_at, VectorRef out) const;

    Mesh mesh_;
    Matrix K_, B_;
    std::optional<Matrix> M_;
    Vector load_;
    /// A column a node, together in one cache line: x, 0.4 exp(-200 (y - .5)^2), exp(-355.56 (...)).
    DenseMatrix factors_;
};

/// The member at gamma of the family, with its mesh.
Scene membrane(Index n, const Parameter& gamma, Motion motion = Motion::none);

}  // namespace tact
