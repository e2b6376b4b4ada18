#include <memory>
#include <tact/contact/dense/dense_contact.hpp>
#include <tact/lib/time/stage.hpp>

// A shared library, as a Python module is one, with all of tact in it.
extern "C" double on_the_floor() {
    tact::ContactProblem mass;
    mass.K = tact::Matrix::identity(1);
    mass.B = tact::Matrix::identity(1);
    mass.c = tact::Vector(tact::Vector::Constant(1, -1));
    mass.f = tact::Vector(tact::Vector::Constant(1, -3));
    tact::ContactWorkspace workspace(std::make_shared<tact::DenseContact>());
    return tact::solve_static(mass, workspace).lambda[0];
}
