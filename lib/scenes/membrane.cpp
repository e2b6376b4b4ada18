#include "membrane.hpp"

#include <algorithm>
#include <cmath>

#include "../errors.hpp"

namespace tact {
namespace {

SparseMatrix five_point_stencil(Index n) {
    SparseMatrix K(n * n, n * n);
    K.reserve(Eigen::Matrix<long, Eigen::Dynamic, 1>::Constant(n * n, 5));
    for (Index j = 0; j < n; ++j)
        for (Index i = 0; i < n; ++i) {
            const Index node = i + n * j;
            if (j > 0) K.insert(node - n, node) = -1;
            if (i > 0) K.insert(node - 1, node) = -1;
            K.insert(node, node) = 4;
            if (i + 1 < n) K.insert(node + 1, node) = -1;
            if (j + 1 < n) K.insert(node + n, node) = -1;
        }
    K.makeCompressed();
    return K;
}

}  // namespace

MembraneFamily::MembraneFamily(Index n, Motion motion) : mesh_(Mesh::unit_square(n)), factors_(3, n * n) {
    const double area = mesh_.h() * mesh_.h();
    K_ = Matrix(five_point_stencil(n));
    B_ = Matrix::identity(n * n);
    if (motion == Motion::dynamic) M_ = Matrix::diagonal(Vector::Constant(n * n, area));
    load_ = Vector::Constant(n * n, -10 * area);
    for (Index node = 0; node < n * n; ++node) {
        const double x = mesh_.x(node), dx = x - 0.7, dy = mesh_.y(node) - 0.5;
        factors_.col(node) << x, 0.4 * std::exp(-200 * dy * dy), std::exp(-355.56 * (dx * dx + dy * dy));
    }
}

void MembraneFamily::check(const Parameter& gamma) const {
    if (gamma.size() != 2)
        throw InputError("MembraneFamily: gamma is " + std::to_string(gamma.size()) + "x1, expected 2x1");
    if (!gamma.allFinite())
        throw InputError("MembraneFamily: gamma has a NaN or infinite entry, expected finite entries");
}

template <class RowAt>
void MembraneFamily::fill(const Parameter& gamma, Index count, RowAt row_at, VectorRef out) const {
    check(gamma);
    if (out.size() != count)
        throw InputError("MembraneFamily: gap's out is " + std::to_string(out.size()) + "x1, expected " +
                         std::to_string(count) + "x1");
    Eigen::Array<double, block_, 1> bump, fixed;
    for (Index start = 0; start < count; start += block_) {
        const Index size = std::min(block_, count - start);
        for (Index k = 0; k < size; ++k) {
            const double* factor = factors_.data() + 3 * row_at(start + k);
            bump[k] = factor[0] - gamma[0];
            out[start + k] = factor[1];
            fixed[k] = factor[2];
        }
        auto c = out.segment(start, size).array();
        c = gamma[1] * fixed.head(size) - 1 + c * (-200 * bump.head(size).square()).exp();
    }
}

void MembraneFamily::gap(const Parameter& gamma, std::span<const Index> rows, VectorRef out) const {
    const Index nodes = mesh_.nodes();
    for (const Index row : rows)
        if (row < 0 || row >= nodes)
            throw InputError("MembraneFamily: gap's row is " + std::to_string(row) + ", expected in [0, " +
                             std::to_string(nodes) + ")");
    const auto row_at = [rows](Index k) { return rows[static_cast<std::size_t>(k)]; };
    fill(gamma, static_cast<Index>(rows.size()), row_at, out);
}

ContactProblem MembraneFamily::at(const Parameter& gamma) const {
    Vector c(mesh_.nodes());
    fill(
        gamma, mesh_.nodes(), [](Index k) { return k; }, c);
    ContactProblem problem;
    problem.M = M_;
    problem.K = K_;
    problem.B = B_;
    problem.c = std::move(c);
    problem.f = load_;
    problem.u0 = Vector::Zero(mesh_.nodes());
    if (M_) problem.v0 = Vector::Zero(mesh_.nodes());
    return problem;
}

Scene membrane(Index n, const Parameter& gamma, Motion motion) {
    const MembraneFamily family(n, motion);
    return {family.at(gamma), family.mesh()};
}

}  // namespace tact
