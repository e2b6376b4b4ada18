#include "indefinite.hpp"

#include <Eigen/Cholesky>
#include <Eigen/SparseCholesky>
#include <cmath>
#include <optional>
#include <sstream>

namespace tact {
namespace {

/// Beyond this a factorisation is not worth a message.
constexpr Index largest = 50000;
/// Of the terms of x'Ax: below it is rounding.
constexpr double rounding = 1e-12;

/// x'Ax, where that is negative beyond rounding.
std::optional<double> negative_curvature(const Matrix& A, const Vector& x) {
    const SparseMatrix S = A.to_sparse();
    const double curvature = x.dot(S * x);
    const double terms = x.cwiseAbs().dot(S.cwiseAbs() * x.cwiseAbs());
    if (std::isfinite(curvature) && curvature < -rounding * terms) return curvature;
    return std::nullopt;
}

/// L'x = e_j for the most negative pivot of a factor L D L' = A: x'Ax is that pivot.
template <class Solve> Vector along_pivot(const Vector& pivots, Solve solve) {
    Index j = 0;
    if (!(pivots.minCoeff(&j) < 0)) return {};
    return solve(Vector(Vector::Unit(pivots.size(), j)));
}

/// A direction x with x'Ax < 0, or an empty vector where none was found.
Vector direction_of_negative_curvature(const Matrix& A) {
    const Vector diagonal = A.main_diagonal();
    Index i = 0;
    if (diagonal.size() == 0 || !A.all_finite()) return {};
    if (diagonal.minCoeff(&i) < -rounding * diagonal.lpNorm<Eigen::Infinity>())
        return Vector::Unit(diagonal.size(), i);
    if (A.diagonal_entries() || A.rows() > largest) return {};
    Vector x;
    if (A.dense()) {
        const DenseMatrix symmetric = 0.5 * (*A.dense() + A.dense()->transpose());
        const Eigen::LDLT<DenseMatrix> factor(symmetric);
        x = along_pivot(factor.vectorD(), [&](Vector e) -> Vector {
            factor.matrixU().solveInPlace(e);
            return factor.transpositionsP().transpose() * e;
        });
    } else {
        const SparseMatrix transposed = A.sparse()->transpose();
        const SparseMatrix symmetric = 0.5 * (*A.sparse() + transposed);
        Eigen::SimplicialLDLT<SparseMatrix> factor;
        // No pivot is exactly zero: a free body is not indefinite.
        factor.setShift(rounding * diagonal.lpNorm<Eigen::Infinity>());
        factor.compute(symmetric);
        if (factor.info() != Eigen::Success) return {};
        x = along_pivot(factor.vectorD(), [&](Vector e) -> Vector {
            factor.matrixU().solveInPlace(e);
            return factor.permutationPinv() * e;
        });
    }
    return x.size() > 0 && x.allFinite() && negative_curvature(A, x) ? x : Vector();
}

/// "K(3, 3) is -2", or "x'Kx is -2 for some x with largest entry 1 at 7".
std::string evidence(const char* name, const Matrix& A, Vector x) {
    std::ostringstream text;
    Index at = 0;
    x /= x.cwiseAbs().maxCoeff(&at);
    if ((x.array() != 0).count() == 1)
        text << name << "(" << at << ", " << at << ") is " << A.main_diagonal()[at];
    else
        text << "x'" << name << "x is " << *negative_curvature(A, x) << " for an x with its largest entry, 1, in "
             << at;
    return text.str();
}

std::string combination_in_letters(const ContactProblem& p, const Combination& c) {
    std::ostringstream text;
    const auto add = [&](double factor, const char* name) {
        if (factor == 0) return;
        if (text.tellp() > 0) text << " + ";
        if (factor != 1) text << factor << " ";
        text << name;
    };
    if (p.M) add(c.mass, "M");
    if (p.D) add(c.damping, "D");
    add(c.stiffness, "K");
    return text.str();
}

}  // namespace

std::string why_indefinite(const ContactProblem& p, const Combination& c) {
    const Vector x = direction_of_negative_curvature(combined(p, c));
    if (x.size() == 0) return {};
    std::ostringstream text;
    text << "ContactProblem: ";
    const auto name_if_indefinite = [&](const char* name, const Matrix& A) {
        // The combination's own direction is evidence for one of them at least.
        const Vector own = negative_curvature(A, x) ? x : direction_of_negative_curvature(A);
        if (own.size() == 0) return false;
        text << name << " is indefinite: " << evidence(name, A, own) << ", expected >= 0; ";
        return true;
    };
    if (p.M && c.mass != 0) (void)name_if_indefinite("M", *p.M);
    if (p.D && c.damping != 0) (void)name_if_indefinite("D", *p.D);
    const bool soft = c.stiffness != 0 && name_if_indefinite("K", p.K);
    text << "so is " << combination_in_letters(p, c);
    if (soft && p.M && c.mass != 0) {
        const double inertia = x.dot(*p.M * x);
        if (inertia > 0)
            text << "; M outweighs K only for a smaller dt (the factor of M, which grows with 1/dt^2, must exceed "
                 << -x.dot(p.K * x) * c.stiffness / inertia << ")";
    }
    return text.str();
}

}  // namespace tact
