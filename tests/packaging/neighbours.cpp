// A program that uses tact and another library with Eigen, compiled with flags that are not tact's. Objects with memory of
// their own go every way: made here and destroyed in tact, made there and destroyed here.
#include <Eigen/Dense>
#include <cmath>
#include <cstdio>
#include <memory>
#include <utility>
#include <vector>

#include <tact/contact/dense/dense_contact.hpp>
#include <tact/integrators/trapezoid.hpp>
#include <tact/lib/scenes/membrane.hpp>
#include <tact/lib/time/trajectory.hpp>
#include <tact/rom/model/reduce.hpp>
#include <tact/rom/model/reduced_basis.hpp>
#include <tact/rom/model/reduced_model.hpp>

#include "neighbour.hpp"

namespace {

int failures = 0;

void expect(bool right, const char* what) {
    if (right) return;
    std::printf("wrong: %s\n", what);
    ++failures;
}

tact::ContactProblem weighed_down(int n) {
    tact::ContactProblem chain;
    Eigen::MatrixXd K = Eigen::MatrixXd::Zero(n, n);
    for (int i = 0; i < n; ++i) {
        K(i, i) = 2;
        if (i > 0) K(i, i - 1) = K(i - 1, i) = -1;
    }
    chain.K = tact::Matrix(tact::DenseMatrix(K));
    chain.B = tact::Matrix::identity(n);
    chain.c = Eigen::VectorXd::Constant(n, -1);  // u >= -1
    const Eigen::VectorXd f = -n * weights(n);
    chain.f = f;
    return chain;
}

}  // namespace

int main() {
    constexpr int n = 37;
    tact::ContactWorkspace workspace(std::make_shared<tact::DenseContact>());
    {
        tact::StaticSolution s = tact::solve_static(weighed_down(n), workspace);
        expect(s.report.outcome == tact::Outcome::converged, "outcome");
        expect(std::abs(s.u.minCoeff() + 1) < 1e-13, "the chain lies on the floor");
        const Eigen::VectorXd copy = s.u;  // and out of tact
        s.u = tact::Vector();
        expect(copy.size() == n && std::abs(copy.minCoeff() + 1) < 1e-13, "copy");
        tact::Vector moved = std::move(s.lambda);
        moved.conservativeResize(n + 3);
        expect(moved.head(n).minCoeff() >= 0, "forces");
    }
    {
        const Eigen::MatrixXd A = Eigen::MatrixXd::Identity(n, n) * 3, X = inverse_of(A);
        expect((A * X - Eigen::MatrixXd::Identity(n, n)).norm() < 1e-12, "the other library");
    }
    {
        const tact::MembraneFamily family(9, tact::Motion::dynamic);
        tact::ContactProblem problem = family.at(Eigen::Vector2d(0.45, 0.4));
        problem.f = tact::AffineVector::function(
            problem.size(), [](double, tact::Side, tact::VectorRef out) { out.setConstant(-0.1); });
        tact::MarchReport march =
            tact::integrate(tact::Trapezoid(), problem, tact::TimeGrid::until(0.2, 0.01), workspace);
        expect(march.outcome == tact::Outcome::converged, "march");
        const tact::State last = std::move(march.final_state);
        expect(last.u().norm() > 0, "it moves");
    }
    {
        const tact::ContactProblem full = weighed_down(n);
        tact::ReducedBasis basis;
        basis.U = tact::DenseMatrix::Identity(n, n);
        basis.U_lambda = tact::DenseMatrix::Identity(n, n);
        const tact::ContactProblem reduced = tact::reduce(full, basis);
        // Inside, these use matrices of Eigen's own kind and functions that this program compiles too.
        expect((tact::modal_basis(full, basis).U.transpose() * full.K.times(tact::modal_basis(full, basis).U) -
                tact::DenseMatrix::Identity(n, n))
                       .norm() < 1e3,
               "modes");
        Eigen::MatrixXd resized(2, 2);
        for (int size = 3; size < 9; ++size) resized.resize(size, size + 1);
        expect(resized.size() == 72, "resized");
        expect(tact::report_basis(reduced, {}).p == n, "report");
        const Eigen::VectorXd u = tact::solve_static(reduced, workspace).u;
        expect((u - tact::solve_static(full, workspace).u).norm() < 1e-12, "reduced");
    }
    std::vector<tact::Vector> several(5, tact::Vector(Eigen::VectorXd::Ones(n)));
    several.resize(11, tact::Vector::Zero(n));
    if (failures == 0) std::puts("neighbours agree");
    return failures;
}
