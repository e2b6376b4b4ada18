#include <iostream>
#include <tact/tact.hpp>

// README.md shows this program; tests/house/readme.py compares the two.
int main() {
    // Three masses on four springs under their own weight, over a floor the middle one cannot pass.
    tact::ContactProblem masses;
    masses.K = tact::Matrix(tact::DenseMatrix{{2, -1, 0}, {-1, 2, -1}, {0, -1, 2}});
    masses.B = tact::Matrix(tact::DenseMatrix{{0, 1, 0}});                       // B u - c >= 0:
    masses.c = tact::AffineVector(tact::Vector(tact::Vector::Constant(1, -1)));  // u_2 >= -1
    masses.f = tact::AffineVector(tact::Vector(tact::Vector::Constant(3, -1)));
    const tact::StaticSolution rest = tact::solve(masses);
    std::cout << "u_2 = " << rest.u[1] << ", contact force " << rest.lambda[0] << "\n" << rest << "\n";

    // The same masses let go from the straight position: they fall on the floor and bounce.
    masses.M = tact::Matrix::identity(3);
    masses.u0 = masses.v0 = tact::Vector::Zero(3);
    const tact::TimeGrid grid = tact::TimeGrid::until(10, 0.01);
    const tact::March march = tact::march(masses, tact::Scheme::named("trapezoid:e=0.5", grid));
    std::cout << "lowest u_2 " << march.u.col(1).minCoeff() << "\n" << march << "\n";
    return rest.u[1] == -1 && march.u.col(1).minCoeff() >= -1 - 1e-12 && march.report.first_contact_step > 0 ? 0 : 1;
}
