// Programmes drawn from many shapes, most with a planted solution, and the verdict on what each strategy says of them.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <random>
#include <string>

#include "../../lib/errors.hpp"
#include "judge.hpp"
#include "strategies.hpp"

namespace tact::laws {

enum class Truth { solvable, infeasible, unknown };

struct Generated {
    QuadraticProgram qp;
    Vector guess;
    std::optional<Vector> u;  // the only solution
    Truth truth = Truth::solvable;
    double condition = 1;  // of A in unknowns of unit stiffness, about; infinity if singular
    bool as_sparse = false, symmetric = true, scaled = false;
    Rows rows = Rows::general;
};

class Generator {
public:
    explicit Generator(std::uint64_t seed) : random_(seed) {}

    Generated draw() {
        Generated g;
        const Index n = integer(1, 12);
        g.rows = static_cast<Rows>(integer(0, 2));
        Index m = integer(0, 10);
        if (g.rows == Rows::bounds) m = std::min(m, n);
        if (g.rows == Rows::pairs) m = std::min(m, n / 2);
        draw_stiffness(g, n);
        draw_rows(g, m, n);
        const bool planted = chance(0.7);
        plant(g, planted);
        if (chance(0.1) && m > 0) exclude(g);
        if (chance(0.2)) scale(g);
        g.as_sparse = chance(0.5);
        g.guess = Vector::Zero(g.qp.c.size());
        if (chance(0.3))
            for (double& x : g.guess) x = std::max(0.0, normal());
        if (g.truth == Truth::solvable && !g.u && g.condition < 1e6 && !g.scaled && g.qp.c.size() <= 7) {
            const auto exact = by_enumeration(g.qp);
            if (exact) g.u = exact->u;
        }
        return g;
    }

private:
    double uniform(double a, double b) { return std::uniform_real_distribution<double>(a, b)(random_); }
    double normal() { return std::normal_distribution<double>()(random_); }
    bool chance(double p) { return uniform(0, 1) < p; }
    Index integer(Index a, Index b) { return std::uniform_int_distribution<Index>(a, b)(random_); }
    DenseMatrix matrix(Index rows, Index cols) {
        return DenseMatrix::NullaryExpr(rows, cols, [this] { return normal(); });
    }

    void draw_stiffness(Generated& g, Index n) {
        const DenseMatrix Q = Eigen::HouseholderQR<DenseMatrix>(matrix(n, n)).householderQ();
        g.condition = chance(0.6) ? std::pow(10, uniform(0, 3)) : std::pow(10, uniform(3, 12));
        Vector eigenvalues(n);
        for (double& x : eigenvalues) x = std::pow(g.condition, -uniform(0, 1));
        if (chance(0.08)) {
            eigenvalues.head(integer(1, n)).setZero();
            g.condition = infinity;
        }
        g.qp.A = Q * eigenvalues.asDiagonal() * Q.transpose();
        g.qp.A = (0.5 * (g.qp.A + g.qp.A.transpose())).eval();
        if (chance(0.15)) {  // a mesh instead: an M-matrix
            g.condition = static_cast<double>(n * n);
            g.qp.A.setZero();
            for (Index i = 0; i < n; ++i) {
                g.qp.A(i, i) = 2;
                if (i > 0) g.qp.A(i, i - 1) = g.qp.A(i - 1, i) = -1;
            }
        }
        if (chance(0.12)) {
            const DenseMatrix skew = matrix(n, n);
            g.qp.A += skew - skew.transpose();
            g.symmetric = n == 1;
        }
    }

    void draw_rows(Generated& g, Index m, Index n) {
        DenseMatrix& B = g.qp.B;
        B = DenseMatrix::Zero(m, n);
        const bool whole = chance(0.4);  // small integers: ties, dependence
        for (Index i = 0; i < m; ++i) {
            if (g.rows == Rows::bounds) {
                B(i, i) = whole ? 1 : (chance(0.5) ? 1 : -1) * uniform(0.2, 2);
            } else if (g.rows == Rows::pairs) {
                B(i, 2 * i) = 1;
                B(i, 2 * i + 1) = -1;
            } else {
                for (Index j = 0; j < n; ++j) B(i, j) = whole ? static_cast<double>(integer(-1, 1)) : normal();
            }
        }
        if (g.rows != Rows::general) return;
        for (Index i = 1; i < m; ++i)
            if (chance(0.1))
                B.row(i) = (chance(0.5) ? 1 : -1) * B.row(i - 1);
            else if (i > 1 && chance(0.05))
                B.row(i) = B.row(i - 1) + 2 * B.row(i - 2);
    }

    /// Rows through or below a point; planted: b such that the point is the solution, some multipliers zero on active rows.
    void plant(Generated& g, bool planted) {
        const Index n = g.qp.A.rows(), m = g.qp.B.rows();
        Vector u(n), lambda = Vector::Zero(m);
        const double size = chance(0.1) ? 0 : 1;
        for (double& x : u) x = size * normal();
        g.qp.c = g.qp.B * u;
        const double touching = uniform(0, 1);
        for (Index i = 0; i < m; ++i)
            if (chance(touching))
                lambda[i] = chance(0.8) ? std::exp(normal()) : 0;
            else
                g.qp.c[i] -= chance(0.1) ? infinity : chance(0.1) ? 1e20 : std::exp(2 * normal());
        g.qp.b = g.qp.A * u - g.qp.B.transpose() * lambda;
        if (planted) {
            if (std::isfinite(g.condition)) g.u = u;
            return;
        }
        for (double& x : g.qp.b) x = normal();
        if (!std::isfinite(g.condition)) g.truth = Truth::unknown;
    }

    /// One more row against the sum of two, out of reach.
    void exclude(Generated& g) {
        const Index m = g.qp.B.rows(), n = g.qp.B.cols(), i = integer(0, m - 1), j = integer(0, m - 1);
        if (!(g.qp.c[i] > -1e10 && g.qp.c[j] > -1e10)) return;
        g.qp.B.conservativeResize(m + 1, n);
        g.qp.c.conservativeResize(m + 1);
        g.qp.B.row(m) = -(g.qp.B.row(i) + 3 * g.qp.B.row(j));
        g.qp.c[m] = -(g.qp.c[i] + 3 * g.qp.c[j]) + std::pow(10, uniform(-3, 2));
        g.truth = Truth::infeasible;
        g.rows = Rows::general;
        g.u.reset();
    }

    /// Unknowns and rows in other units.
    void scale(Generated& g) {
        const Index n = g.qp.A.rows(), m = g.qp.B.rows();
        Vector D(n), R(m);
        for (double& x : D) x = std::pow(10, uniform(-6, 6));
        for (double& x : R) x = std::pow(10, uniform(-6, 6));
        g.qp.A = (D.asDiagonal() * g.qp.A * D.asDiagonal()).eval();
        for (Index j = 0; j < n; ++j)  // the same rounding on both sides
            for (Index i = 0; i < j && g.symmetric; ++i) g.qp.A(i, j) = g.qp.A(j, i);
        g.qp.B = (R.asDiagonal() * g.qp.B * D.asDiagonal()).eval();
        g.qp.b = D.cwiseProduct(g.qp.b);
        g.qp.c = R.cwiseProduct(g.qp.c);
        if (g.u) g.u = g.u->cwiseQuotient(D);
        if (g.truth == Truth::infeasible) g.truth = Truth::unknown;  // rounding of the rows may part them
        g.scaled = true;
    }

    std::mt19937_64 random_;
};

enum class Verdict { right, infeasible, gave_up, refused, missed, wrong };
inline constexpr std::array verdict_names{"right", "infeasible", "gave up", "refused", "missed", "WRONG"};

struct Judged {
    Verdict verdict;
    std::string why;
    Solved solved;
};

/// e'A e of u against the planted solution, by the size of its terms.
inline bool near(const Generated& g, const Vector& u) {
    Wide distance = 0, size = 0;
    for (Index i = 0; i < u.size(); ++i)
        for (Index j = 0; j < u.size(); ++j) {
            const Wide a = g.qp.A(i, j);
            distance += a * (Wide(u[i]) - (*g.u)[i]) * (Wide(u[j]) - (*g.u)[j]);
            size += std::abs(a * (*g.u)[i] * (*g.u)[j]);
        }
    for (Index i = 0; i < u.size(); ++i) size += std::abs(Wide(g.qp.b[i]) * (*g.u)[i]);
    Wide reach = 0;
    for (Index i = 0; i < u.size(); ++i) reach += std::abs(Wide(g.qp.b[i]) * g.qp.b[i] / g.qp.A(i, i));
    constexpr Wide denormal = std::numeric_limits<double>::min();
    return distance <= 1e-12L * (size + reach) + denormal * denormal;
}

/// `missed`: no answer where there is one, which only the chooser owes: its chain ends in methods that are finite, up to
/// a condition of 1e10 (1e8 without symmetry).
inline Judged judge(const Generated& g, const Strategy& strategy) {
    const auto matrix = [&](const DenseMatrix& M) { return g.as_sparse ? Matrix(Matrix(M).to_sparse()) : Matrix(M); };
    Judged j{Verdict::refused, {}, {}};
    const bool takes = std::ranges::find(strategy.takes, g.rows) != strategy.takes.end();
    if (!takes || (!g.symmetric && !strategy.unsymmetric)) return j;
    const bool chooser = std::string(strategy.name) == "AutomaticContact";
    const bool definite = g.condition < (g.symmetric ? 1e10 : 1e8);
    try {
        j.solved = solve(*strategy.solver, matrix(g.qp.A), matrix(g.qp.B), g.qp.b, g.qp.c, g.guess);
    } catch (const InputError& error) {
        j.why = error.what();
        if (chooser) j.verdict = g.symmetric && g.truth == Truth::solvable ? Verdict::missed : Verdict::refused;
        return j;
    } catch (const NumericalError& error) {
        j.why = error.what();
        if (chooser) j.verdict = definite ? Verdict::missed : Verdict::refused;
        return j;
    }
    const ContactReport& report = j.solved.report;
    const Vector noise = (chooser && g.condition < 1e8 ? 1e-13 : 1e-12) * size_of_free_solution(g.qp);
    j.why = fault(g.qp, report, j.solved.u, j.solved.lambda, noise);
    if (j.why.empty() && report.outcome == Outcome::converged) {
        // Rows that exclude each other by less than the judge's tolerance may be met; else fault() has said so.
        if (g.u && g.condition < 1e8 && g.symmetric && !near(g, j.solved.u)) j.why = "far from the planted solution";
    }
    if (j.why.empty() && report.outcome == Outcome::infeasible && g.truth == Truth::solvable)
        j.why = "infeasible, but there is a solution";
    if (j.why.empty() && report.outcome == Outcome::unbounded && definite && chooser)
        j.why = "unbounded, A is definite";
    if (!j.why.empty()) {
        j.verdict = Verdict::wrong;
        return j;
    }
    if (report.outcome == Outcome::converged) {
        j.verdict = Verdict::right;
    } else if (report.outcome == Outcome::infeasible) {
        j.verdict = Verdict::infeasible;
    } else {
        j.why = std::string(to_string(report.outcome)) + " by " + std::string(report.strategy);
        j.verdict = chooser && definite && g.truth != Truth::unknown ? Verdict::missed : Verdict::gave_up;
    }
    return j;
}

}  // namespace tact::laws
