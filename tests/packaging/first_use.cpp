#include <cstdio>
#include <memory>
#include <tact/contact/dense/dense_contact.hpp>
#include <tact/lib/time/stage.hpp>

// README.md shows this program; tests/house/readme.py compares the two.
int main() {
    // Three masses on four springs under their own weight, over a floor the middle one cannot pass.
    tact::ContactProblem masses;
    masses.K = tact::Matrix(tact::DenseMatrix{{2, -1, 0}, {-1, 2, -1}, {0, -1, 2}});
    masses.B = tact::Matrix(tact::DenseMatrix{{0, 1, 0}});                       // B u - c >= 0:
    masses.c = tact::AffineVector(tact::Vector(tact::Vector::Constant(1, -1)));  // u_2 >= -1
    masses.f = tact::AffineVector(tact::Vector(tact::Vector::Constant(3, -1)));
    tact::ContactWorkspace workspace(std::make_shared<tact::DenseContact>());
    const tact::StaticSolution s = tact::solve_static(masses, workspace);
    std::printf("u_2 = %g, contact force %g, KKT residual %.0e\n", s.u[1], s.lambda[0], s.report.kkt.largest());
    return s.report.outcome == tact::Outcome::converged && s.u[1] == -1 ? 0 : 1;
}
