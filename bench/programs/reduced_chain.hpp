// A reduced model built in memory, for the online programs.
#pragma once

#include "../../contact/dense/dense_contact.hpp"
#include "../../rom/model/reduce.hpp"

namespace tact::bench {

/// Four sine modes of a chain of 64 masses over a floor that its middle cannot pass.
inline ContactProblem reduced_chain(bool moves) {
    constexpr Index n = 64, p = 4;
    DenseMatrix K = DenseMatrix::Zero(n, n);
    K.diagonal().setConstant(2);
    K.diagonal<1>().setConstant(-1);
    K.diagonal<-1>().setConstant(-1);
    ContactProblem chain;
    chain.K = Matrix(K);
    if (moves) chain.M = Matrix::identity(n);
    DenseMatrix row = DenseMatrix::Zero(1, n);
    row(0, n / 2) = 1;
    chain.B = Matrix(row);
    chain.c = AffineVector(Vector(Vector::Constant(1, -1)));
    chain.f = AffineVector(Vector(Vector::Constant(n, -0.01)));
    chain.u0 = chain.v0 = Vector::Zero(n);
    ReducedBasis basis{DenseMatrix(n, p), DenseMatrix::Ones(1, 1)};
    for (Index j = 0; j < p; ++j)
        for (Index i = 0; i < n; ++i)
            basis.U(i, j) = std::sin(3.14159265358979 * static_cast<double>((j + 1) * (i + 1)) / (n + 1));
    return reduce(chain, modal_basis(chain, basis));
}

}  // namespace tact::bench
