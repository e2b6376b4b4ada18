#include "radial_obstacle.hpp"

#include <cmath>

namespace tact {
namespace {

double ball(double r2) {
    constexpr double last = 0.9;
    if (r2 <= last) return std::sqrt(1 - r2);
    const double edge = std::sqrt(1 - last);
    return edge - (r2 - last) / (2 * edge);
}

}  // namespace

double radial_obstacle_exact(double x, double y) {
    constexpr double a = 0.697965148223374, A = 0.680259411891719, B = 0.471519893402112;
    const double r2 = x * x + y * y;
    return r2 <= a * a ? std::sqrt(1 - r2) : B - 0.5 * A * std::log(r2);
}

Scene radial_obstacle(Index n) {
    Scene scene{{}, Mesh::unit_square(n)};
    const auto coordinate = [n](Index i) { return 4 * static_cast<double>(i + 1) / static_cast<double>(n + 1) - 2; };
    SparseMatrix K(n * n, n * n);
    K.reserve(Eigen::Matrix<long, Eigen::Dynamic, 1>::Constant(n * n, 5));
    Vector f = Vector::Zero(n * n), c(n * n);
    for (Index j = 0; j < n; ++j)
        for (Index i = 0; i < n; ++i) {
            const Index node = i + n * j;
            const auto couple = [&](Index p, Index q) {
                if (p >= 0 && p < n && q >= 0 && q < n)
                    K.insert(p + n * q, node) = -1;
                else
                    f[node] += radial_obstacle_exact(coordinate(p), coordinate(q));
            };
            couple(i, j - 1);
            couple(i - 1, j);
            K.insert(node, node) = 4;
            couple(i + 1, j);
            couple(i, j + 1);
            c[node] = ball(coordinate(i) * coordinate(i) + coordinate(j) * coordinate(j));
        }
    scene.problem.K = Matrix(std::move(K));
    scene.problem.B = Matrix::identity(n * n);
    scene.problem.c = std::move(c);
    scene.problem.f = std::move(f);
    scene.problem.u0 = Vector::Zero(n * n);
    return scene;
}

}  // namespace tact
