#include "contact_problem.hpp"

#include <cmath>
#include <string>

#include "../errors.hpp"

namespace tact {

void AffineVector::evaluate(double t, Side side, VectorRef scratch, VectorRef out) const {
    if (!coefficients) {
        if (modes.cols() == 1)
            out = modes.col(0);
        else
            out = modes.rowwise().sum();
        return;
    }
    const Index k = modes.cols();
    coefficients(t, side, scratch.head(k));
    out = scratch[0] * modes.col(0);
    for (Index j = 1; j < k; ++j)
        if (scratch[j] != 0) out += scratch[j] * modes.col(j);
}

Vector AffineVector::at(double t, Side side) const {
    Vector scratch(modes.cols());
    Vector out(size());
    evaluate(t, side, scratch, out);
    return out;
}

namespace {

[[noreturn]] void reject(const std::string& what) { throw InputError("ContactProblem: " + what); }

std::string square(Index n) { return std::to_string(n) + "x" + std::to_string(n); }

void check_matrix(const char* name, const Matrix& A, Index rows, Index cols) {
    if (A.rows() != rows || A.cols() != cols)
        reject(std::string(name) + " is " + A.shape() + ", expected " + std::to_string(rows) + "x" +
               std::to_string(cols));
    if (!A.all_finite()) reject(std::string(name) + " has a NaN or infinite entry, expected finite entries");
}

void check_vector(const char* name, const Vector& v, Index n) {
    if (v.size() != n)
        reject(std::string(name) + " is " + std::to_string(v.size()) + "x1, expected " + std::to_string(n) + "x1");
    if (!v.allFinite()) reject(std::string(name) + " has a NaN or infinite entry, expected finite entries");
}

void check_affine(const char* name, const AffineVector& a, Index n, bool may_be_minus_infinity) {
    if (a.size() != n)
        reject(std::string(name) + " has " + std::to_string(a.size()) + " rows, expected " + std::to_string(n));
    if (a.modes.cols() < 1) reject(std::string(name) + " has no modes, expected at least one column");
    for (Index j = 0; j < a.modes.cols(); ++j)
        for (Index i = 0; i < n; ++i) {
            const double x = a.modes(i, j);
            if (std::isfinite(x)) continue;
            if (may_be_minus_infinity && a.constant() && x == -infinity) continue;
            reject(std::string(name) + "[" + std::to_string(i) + "] is " + std::to_string(x) + ", expected " +
                   (may_be_minus_infinity ? "a number or, where constant in time, -infinity" : "a finite number"));
        }
}

void check_intervals(const ContactProblem& p) {
    const Index m = p.constraints();
    if (p.c_up) {
        const AffineVector negated(-p.c_up->modes, p.c_up->coefficients, p.c_up->jumps);
        check_affine("-c_up", negated, m, true);
        if (p.c.constant() && p.c_up->constant()) {
            const Vector lower = p.c.at(0), upper = p.c_up->at(0);
            for (Index i = 0; i < m; ++i)
                if (lower[i] > upper[i])
                    reject("c[" + std::to_string(i) + "] is above c_up[" + std::to_string(i) + "]");
        }
    }
    const auto check_force = [m](const char* name, const Vector& force, double sign) {
        if (force.size() != 0 && force.size() != m)
            reject(std::string(name) + " is " + std::to_string(force.size()) + "x1, expected " + std::to_string(m) +
                   "x1 or empty");
        for (Index i = 0; i < force.size(); ++i)
            if (!(sign * force[i] >= 0))
                reject(std::string(name) + "[" + std::to_string(i) + "] is NaN or has the wrong sign, expected " +
                       (sign > 0 ? ">= 0" : "<= 0"));
    };
    check_force("force_lo", p.force_lo, -1);
    check_force("force_up", p.force_up, 1);
}

}  // namespace

void require_contact_rows(const char* who, const ContactProblem& problem) {
    if (!problem.contact_only())
        throw InputError(std::string(who) +
                         ": the problem has rows with an upper bound or a bounded force (c_up, force_lo, "
                         "force_up), expected contact rows B u >= c only; Bdf2, QuasiStatic and solve_static take "
                         "the others");
}

void validate(const ContactProblem& p) {
    const Index n = p.K.rows();
    if (n == 0 || p.K.cols() != n) reject("K is " + p.K.shape() + ", expected square and not empty");
    check_matrix("K", p.K, n, n);
    if (p.M) {
        check_matrix("M", *p.M, n, n);
        if (!p.M->is_symmetric())
            reject("M is " + p.M->shape() + " and not symmetric, expected a symmetric " + square(n));
    }
    if (p.D) check_matrix("D", *p.D, n, n);
    check_matrix("B", p.B, p.B.rows(), n);
    if (p.constraints() > 0) check_affine("c", p.c, p.constraints(), true);
    check_affine("f", p.f, n, false);
    check_intervals(p);
    if (!p.is_static()) check_vector("u0", p.u0, n);
    if (p.second_order()) check_vector("v0", p.v0, n);
    if (p.r && (!p.r->force || !p.r->tangent)) reject("r lacks its force or its tangent, expected both");
}

}  // namespace tact
