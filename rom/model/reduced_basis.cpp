#include "reduced_basis.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>
#include <string>

#include "../../lib/errors.hpp"
#include "orthonormal.hpp"

namespace tact {
namespace {

std::string shape(const DenseMatrix& A) { return std::to_string(A.rows()) + "x" + std::to_string(A.cols()); }

[[noreturn]] void reject(const std::string& what) { throw InputError("ReducedBasis: " + what); }

[[noreturn]] void reject_entry(const char* name, const DenseMatrix& A, Index i, Index j, const char* expected) {
    reject(std::string(name) + "(" + std::to_string(i) + "," + std::to_string(j) + ") is " + shown(A(i, j)) +
           ", expected " + expected);
}

/// x -> U'AU without forming A U twice.
DenseMatrix project(const Matrix& A, const DenseMatrix& U) {
    DenseMatrix A_r = U.transpose() * A.times(U);
    return (A_r + A_r.transpose()) / 2;
}

/// The matrix whose reduced form becomes the identity, or nullptr for U'U = I.
const Matrix* mass_like(const ContactProblem& problem) {
    if (problem.M) return &*problem.M;
    return problem.D ? &*problem.D : nullptr;
}

/// Eigenvectors of K_r x = w mass_r x with x' mass_r x = 1, or nothing if mass_r is not positive definite.
DenseMatrix modes(const DenseMatrix& K_r, const DenseMatrix* mass_r) {
    DenseMatrix to_unit = DenseMatrix::Identity(K_r.rows(), K_r.cols());
    if (mass_r) {
        // By its eigenvectors, not by Cholesky: that keeps the small eigenvalues of a badly scaled mass apart.
        const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> mass(*mass_r);
        const Vector& weights = mass.eigenvalues();
        if (!(weights[0] > 1e-15 * weights[weights.size() - 1])) return {};
        to_unit = mass.eigenvectors() * weights.cwiseSqrt().cwiseInverse().asDiagonal();
    }
    const DenseMatrix scaled = to_unit.transpose() * K_r * to_unit;
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver((scaled + scaled.transpose()) / 2);
    return to_unit * solver.eigenvectors();
}

}  // namespace

void validate(const ReducedBasis& basis, const ContactProblem& problem) {
    const DenseMatrix &U = basis.U, &U_lambda = basis.U_lambda;
    if (U.rows() != problem.size() || U.cols() < 1)
        reject("U is " + shape(U) + ", expected " + std::to_string(problem.size()) + " rows and at least one column");
    if (U_lambda.cols() > 0 && U_lambda.rows() != problem.constraints())
        reject("U_lambda is " + shape(U_lambda) + ", expected " + std::to_string(problem.constraints()) + " rows");
    if (!U.allFinite())
        for (Index j = 0; j < U.cols(); ++j)
            for (Index i = 0; i < U.rows(); ++i)
                if (!std::isfinite(U(i, j))) reject_entry("U", U, i, j, "a finite entry");
    const bool any_sign = basis.signs == DualSigns::any;
    for (Index j = 0; j < U_lambda.cols(); ++j) {
        const auto column = U_lambda.col(j);
        if (column.allFinite() && (any_sign || !(column.array() < 0).any())) continue;
        for (Index i = 0; i < U_lambda.rows(); ++i)
            if (!std::isfinite(column[i]) || (!any_sign && column[i] < 0))
                reject_entry("U_lambda", U_lambda, i, j, any_sign ? "a finite entry" : "a finite entry >= 0");
    }
}

ReducedBasis modal_basis(const ContactProblem& problem, const ReducedBasis& basis) {
    validate(basis, problem);
    ReducedBasis modal{orthonormal_columns(basis.U), basis.U_lambda, basis.signs};
    if (modal.U.cols() == 0) reject("U has only zero columns, expected a non-zero one");
    const Matrix* mass = mass_like(problem);
    if (!problem.K.is_symmetric() || (mass && !mass->is_symmetric())) return modal;
    // Twice: the first rotation leaves off-diagonal entries at the rounding level of the largest eigenvalue, which is
    // much for the smallest ones; the second starts from a nearly diagonal pair and has only those to turn away.
    for (int pass = 0; pass < 2; ++pass) {
        DenseMatrix mass_r;
        if (mass) mass_r = project(*mass, modal.U);
        const DenseMatrix turn = modes(project(problem.K, modal.U), mass ? &mass_r : nullptr);
        if (turn.size() == 0) return modal;
        modal.U = (modal.U * turn).eval();
    }
    fix_signs(modal.U);
    return modal;
}

Vector lift(const ReducedBasis& basis, const ConstVectorRef& q) {
    if (q.size() != basis.U.cols())
        throw InputError("lift: q is " + std::to_string(q.size()) + "x1, expected " + std::to_string(basis.U.cols()) +
                         "x1");
    return basis.U * q;
}

Vector lift_multipliers(const ReducedBasis& basis, const ConstVectorRef& s) {
    if (s.size() != basis.U_lambda.cols())
        throw InputError("lift_multipliers: s is " + std::to_string(s.size()) + "x1, expected " +
                         std::to_string(basis.U_lambda.cols()) + "x1");
    return basis.U_lambda * s;
}

}  // namespace tact
