// A chain of masses above a floor: small enough for dense algebra, with every term a contact problem can have.
#pragma once

#include <cmath>

#include "../../lib/problem/contact_family.hpp"
#include "../scattered.hpp"

namespace tact::testing {

struct ChainParts {
    bool mass = true;
    bool damping = false;
    bool shared_rows = false;  ///< rows of B that share unknowns: B B' is not diagonal
    bool moving_load = true;
};

/// n masses between two walls under a load that pulls them down and sways; contact below every second one, and where
/// rows are shared between neighbours too.
inline ContactProblem chain(Index n, double floor = -0.4, ChainParts parts = {}) {
    std::vector<Eigen::Triplet<double>> k, b;
    for (Index i = 0; i < n; ++i) {
        k.emplace_back(i, i, 2.0 + 0.01 * static_cast<double>(i));
        if (i > 0) k.emplace_back(i, i - 1, -1.0);
        if (i + 1 < n) k.emplace_back(i, i + 1, -1.0);
    }
    Index m = 0;
    for (Index i = 0; i < n; i += 2) b.emplace_back(m++, i, 1.0);
    if (parts.shared_rows)
        for (Index i = 0; i + 1 < n; i += 3) {
            b.emplace_back(m, i, 0.5);
            b.emplace_back(m++, i + 1, 0.5);
        }
    SparseMatrix K(n, n), B(m, n);
    K.setFromTriplets(k.begin(), k.end());
    B.setFromTriplets(b.begin(), b.end());
    ContactProblem problem;
    problem.K = Matrix(K);
    problem.B = Matrix(B);
    if (parts.mass) problem.M = Matrix::diagonal(Vector::LinSpaced(n, 1.0, 1.5));
    if (parts.damping) problem.D = Matrix::diagonal(Vector::LinSpaced(n, 0.2, 0.1));
    DenseMatrix load(n, 2);
    for (Index i = 0; i < n; ++i) {
        load(i, 0) = -0.3;
        load(i, 1) = std::sin(0.7 * static_cast<double>(i));
    }
    if (parts.moving_load)
        problem.f = AffineVector(load,
                                 [](double t, Side, VectorRef out) {
                                     out[0] = 1;
                                     out[1] = 0.2 * std::sin(2 * t);
                                 },
                                 {1.25});
    else
        problem.f = AffineVector(Vector(load.col(0)));
    problem.c = AffineVector(Vector::Constant(m, floor).eval());
    problem.u0 = problem.v0 = Vector::Zero(n);
    return problem;
}

/// The chain over a floor that is a bump of height gamma_1 at gamma_2 (in units of the chain's length).
class ChainFamily : public ContactFamily {
public:
    explicit ChainFamily(Index n, ChainParts parts = {}) : problem_(chain(n, -0.4, parts)) {}
    std::vector<std::string> names() const override { return {"height", "place"}; }
    Parameter lower() const override { return Eigen::Vector2d(0.0, 0.2); }
    Parameter upper() const override { return Eigen::Vector2d(0.3, 0.8); }
    ContactProblem at(const Parameter& gamma) const override {
        ContactProblem problem = problem_;
        for (Index i = 0; i < problem.constraints(); ++i) problem.c.modes(i, 0) = floor(gamma, i);
        return problem;
    }
    void gap(const Parameter& gamma, std::span<const Index> rows, VectorRef out) const override {
        for (std::size_t k = 0; k < rows.size(); ++k) out[static_cast<Index>(k)] = floor(gamma, rows[k]);
    }

private:
    double floor(const Parameter& gamma, Index row) const {
        const double x = static_cast<double>(row) / static_cast<double>(problem_.constraints()) - gamma[1];
        return -0.4 + gamma[0] * std::exp(-30 * x * x);
    }
    ContactProblem problem_;
};

inline DenseMatrix identity(Index n) { return DenseMatrix::Identity(n, n); }

}  // namespace tact::testing
