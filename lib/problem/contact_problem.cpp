#include "contact_problem.hpp"

#include <cmath>
#include <string>

#include "../errors.hpp"

namespace tact {

AffineVector::AffineVector(SparseMatrix modes_, Coefficients coefficients_, std::vector<double> jumps_)
    : coefficients(std::move(coefficients_)),
      jumps(std::move(jumps_)),
      sparse_(std::make_shared<const SparseMatrix>(*Matrix(std::move(modes_)).sparse())) {}

AffineVector AffineVector::function(Index n, Coefficients values, std::vector<double> jumps) {
    if (!values) throw InputError("AffineVector: values is empty, expected a function");
    if (n < 0) throw InputError("AffineVector: n is " + std::to_string(n) + ", expected >= 0");
    AffineVector result;
    result.function_ = std::move(values);
    result.size_ = n;
    result.jumps = std::move(jumps);
    return result;
}

void AffineVector::evaluate(double t, Side side, VectorRef scratch, VectorRef out) const {
    if (function_) {
        function_(t, side, out);
        return;
    }
    const Index k = mode_count();
    if (coefficients) coefficients(t, side, scratch.head(k));
    if (sparse_) {
        out.setZero();
        for (Index j = 0; j < k; ++j)
            for (SparseMatrix::InnerIterator it(*sparse_, j); it; ++it)
                out[it.row()] += coefficients ? scratch[j] * it.value() : it.value();
        return;
    }
    if (!coefficients) {
        if (k == 1)
            out = modes.col(0);
        else
            out = modes.rowwise().sum();
        return;
    }
    out = scratch[0] * modes.col(0);
    for (Index j = 1; j < k; ++j)
        if (scratch[j] != 0) out += scratch[j] * modes.col(j);
}

Vector AffineVector::at(double t, Side side) const {
    Vector scratch(mode_count());
    Vector out(size());
    evaluate(t, side, scratch, out);
    return out;
}

DenseMatrix AffineVector::dense_modes(std::string_view what) const {
    if (function_)
        throw InputError(
            std::string(what) +
            " is a function of its full size, which cannot be reduced; expected modes * coefficients(t)");
    return sparse_ ? DenseMatrix(*sparse_) : modes;
}

namespace {

[[noreturn]] void reject(const std::string& what) { throw InputError("ContactProblem: " + what); }

std::string square(Index n) { return std::to_string(n) + "x" + std::to_string(n); }

/// The first entry that is not finite: "(3,4) is nan", or nothing.
std::string not_finite(const Matrix& A) {
    if (A.all_finite()) return {};
    const auto entry = [](Index i, Index j, double x) {
        return std::string("(").append(std::to_string(i)).append(",").append(std::to_string(j)).append(") is ") +
               shown(x);
    };
    if (const SparseMatrix* S = A.sparse()) {
        for (Index j = 0; j < S->outerSize(); ++j)
            for (SparseMatrix::InnerIterator it(*S, j); it; ++it)
                if (!std::isfinite(it.value())) return entry(it.row(), j, it.value());
    } else if (const DenseMatrix* D = A.dense()) {
        for (Index j = 0; j < D->cols(); ++j)
            for (Index i = 0; i < D->rows(); ++i)
                if (!std::isfinite((*D)(i, j))) return entry(i, j, (*D)(i, j));
    } else {
        const Vector d = A.main_diagonal();
        for (Index i = 0; i < d.size(); ++i)
            if (!std::isfinite(d[i])) return entry(i, i, d[i]);
    }
    return {};
}

void check_matrix(const char* name, const Matrix& A, Index rows, Index cols) {
    if (A.rows() != rows || A.cols() != cols)
        reject(std::string(name) + " is " + A.shape() + ", expected " + std::to_string(rows) + "x" +
               std::to_string(cols));
    if (const std::string entry = not_finite(A); !entry.empty())
        reject(name + entry + ", a NaN or infinite entry; expected finite entries");
}

void check_vector(const char* name, const Vector& v, Index n) {
    if (v.size() != n)
        reject(std::string(name) + " is " + std::to_string(v.size()) + "x1, expected " + std::to_string(n) + "x1");
    for (Index i = 0; i < n; ++i)
        if (!std::isfinite(v[i]))
            reject(std::string(name) + "[" + std::to_string(i) + "] is " + shown(v[i]) +
                   ", a NaN or infinite entry; expected finite entries");
}

/// `off`: the infinity that means no bound, where constant in time; else 0.
void check_affine(const char* name, const AffineVector& a, Index n, double off) {
    if (a.size() != n)
        reject(std::string(name) + " has " + std::to_string(a.size()) + " rows, expected " + std::to_string(n));
    for (std::size_t k = 0; k < a.jumps.size(); ++k) {
        const std::string jump = std::string(name) + ".jumps[" + std::to_string(k) + "] is " + shown(a.jumps[k]);
        if (!std::isfinite(a.jumps[k])) reject(jump + ", expected a finite time");
        if (k > 0 && a.jumps[k] < a.jumps[k - 1])
            reject(jump + ", expected at least the one before, " + shown(a.jumps[k - 1]));
    }
    if (a.is_function()) return;
    if (a.mode_count() < 1) reject(std::string(name) + " has no modes, expected at least one column");
    const auto check = [&](Index i, double x) {
        if (std::isfinite(x) || (off != 0 && a.constant() && x == off)) return;
        reject(std::string(name) + "[" + std::to_string(i) + "] is " + shown(x) + ", expected " +
               (off != 0 ? "a number or, where constant in time, " + shown(off) : "a finite number"));
    };
    for (Index j = 0; j < a.mode_count(); ++j) {
        if (const SparseMatrix* modes = a.sparse_modes())
            for (SparseMatrix::InnerIterator it(*modes, j); it; ++it) check(it.row(), it.value());
        else
            for (Index i = 0; i < n; ++i) check(i, a.modes(i, j));
    }
}

void check_intervals(const ContactProblem& p) {
    const Index m = p.constraints();
    if (p.c_up) {
        check_affine("c_up", *p.c_up, m, infinity);
        if (p.c.constant() && p.c_up->constant()) {
            const Vector lower = p.c.at(0), upper = p.c_up->at(0);
            for (Index i = 0; i < m; ++i)
                if (lower[i] > upper[i])
                    reject("c[" + std::to_string(i) + "] is " + shown(lower[i]) + ", expected at most c_up[" +
                           std::to_string(i) + "], " + shown(upper[i]));
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
    if (p.constraints() > 0) check_affine("c", p.c, p.constraints(), -infinity);
    check_affine("f", p.f, n, 0);
    check_intervals(p);
    if (!p.is_static()) check_vector("u0", p.u0, n);
    if (p.second_order()) check_vector("v0", p.v0, n);
    if (p.r && (!p.r->force || !p.r->tangent)) reject("r lacks its force or its tangent, expected both");
}

}  // namespace tact
