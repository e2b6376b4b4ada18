// Whether a report tells the truth: plain loops over the data in long double, no code of the library.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "../../lib/contact_solver.hpp"
#include "quadratic_programs.hpp"

namespace tact::laws {

using Wide = long double;

/// a / b with 0/0 = 0; what has decayed into underflow of double counts as zero.
inline Wide ratio(Wide a, Wide b) { return a == 0 ? 0 : a / std::max(b, Wide(1e-292L)); }

/// sum_j |M_ij| |x_j| and sum_j M_ij x_j for one row (or column) of M.
struct Sum {
    Wide value = 0, size = 0;
    void add(Wide term) {
        value += term;
        size += std::abs(term);
    }
};

/// Why (u, lambda) is not a solution; empty if it is one. Besides the residuals as lib/kkt.hpp defines them, measures
/// that do not change when unknowns or rows are scaled, so that no large entry hides a wrong small one:
/// each row by its own size, forces over sqrt(A_ii), complementarity as work. `noise`: what each entry of u is allowed to be
/// off whatever its size, such as rounding of A^-1 b; besides 4e-15 of the largest u_i and b_i, in unknowns of unit stiffness:
/// a bound at zero is met to the rounding of the others.
inline std::string fault_of_point(const QuadraticProgram& qp, const Vector& u, const Vector& lambda,
                                  const Vector& noise, Wide tolerance = 2e-9L) {
    const Index n = qp.A.rows(), m = qp.B.rows();
    if (!u.allFinite() || !lambda.allFinite()) return "u or lambda is not finite";
    Wide residual = 0, force = 0, scaled_residual = 0, scaled_force = 0, work = 0;
    for (Index i = 0; i < n; ++i) {
        Sum sum;
        for (Index j = 0; j < n; ++j) sum.add(Wide(qp.A(i, j)) * u[j]);
        sum.add(-Wide(qp.b[i]));
        for (Index k = 0; k < m; ++k) sum.add(-Wide(qp.B(k, i)) * lambda[k]);
        // What would be subnormal in double counts as zero.
        const Wide off = std::abs(sum.value) < std::numeric_limits<double>::min() ? 0 : std::abs(sum.value);
        residual = std::max(residual, off);
        force = std::max(force, sum.size);
        work += std::abs(Wide(u[i])) * sum.size;
        if (!(qp.A(i, i) > 0)) continue;
        scaled_residual = std::max(scaled_residual, off / std::sqrt(Wide(qp.A(i, i))));
        scaled_force = std::max(scaled_force, sum.size / std::sqrt(Wide(qp.A(i, i))));
    }
    if (ratio(residual, force) > tolerance) return "stationarity";
    if (ratio(scaled_residual, scaled_force) > 100 * tolerance) return "stationarity in scaled unknowns";
    Wide largest_multiplier = 0;
    for (Index i = 0; i < m; ++i) largest_multiplier = std::max<Wide>(largest_multiplier, lambda[i]);
    Wide reach = 0;  // in unknowns of unit stiffness
    for (Index i = 0; i < n; ++i)
        if (const Wide unit = std::sqrt(Wide(qp.A(i, i))); unit > 0)
            reach = std::max({reach, std::abs(Wide(u[i])) * unit, std::abs(Wide(qp.b[i])) / unit});
    Wide complementary_work = 0;
    for (Index i = 0; i < m; ++i) {
        if (lambda[i] < 0) return "negative multiplier on row " + std::to_string(i);
        if (qp.c[i] == -infinity) {
            if (lambda[i] != 0) return "multiplier on a row that is off";
            continue;
        }
        Sum gap;
        Wide own = std::abs(Wide(qp.c[i])), allowed = 0;
        for (Index j = 0; j < n; ++j) {
            gap.add(Wide(qp.B(i, j)) * u[j]);
            own += std::abs(Wide(qp.B(i, j)) * u[j]);
            allowed += std::abs(Wide(qp.B(i, j))) * noise[j];
            if (qp.A(j, j) > 0) allowed += std::abs(Wide(qp.B(i, j))) * 4e-15L * reach / std::sqrt(Wide(qp.A(j, j)));
        }
        gap.add(-Wide(qp.c[i]));
        own = std::max(own, Wide(1e-292L));  // as in ratio()
        if (gap.value < -5 * tolerance * own - allowed) return "penetration of row " + std::to_string(i);
        if (gap.value > 0) complementary_work += lambda[i] * std::max<Wide>(gap.value - allowed, 0);
        work += lambda[i] * gap.size;
    }
    if (ratio(complementary_work, work) > 100 * tolerance) return "complementarity";
    return {};
}

/// Why y does not show that no u satisfies the rows.
inline std::string fault_of_certificate(const QuadraticProgram& qp, const Vector& y, Wide tolerance = 1e-8L) {
    const Index n = qp.A.rows(), m = qp.B.rows();
    if (y.size() != m || !y.allFinite()) return "certificate of infeasibility is missing or not finite";
    Sum value;
    for (Index i = 0; i < m; ++i) {
        if (y[i] < 0) return "certificate of infeasibility is negative";
        if (y[i] > 0) value.add(Wide(y[i]) * qp.c[i]);
    }
    if (!(value.value > 0)) return "certificate of infeasibility: c'y <= 0";
    Wide rest = 0, size = 0;  // in unknowns of unit stiffness
    for (Index j = 0; j < n; ++j) {
        Sum column;
        for (Index i = 0; i < m; ++i) column.add(Wide(y[i]) * qp.B(i, j));
        const Wide unit = qp.A(j, j) > 0 ? std::sqrt(Wide(qp.A(j, j))) : 1;
        rest = std::max(rest, std::abs(column.value) / unit);
        size = std::max(size, column.size / unit);
    }
    return rest > tolerance * size ? "certificate of infeasibility: B'y is not zero" : "";
}

/// Why d does not show that the objective falls for ever.
inline std::string fault_of_ray(const QuadraticProgram& qp, const Vector& d, Wide tolerance = 1e-7L) {
    const Index n = qp.A.rows(), m = qp.B.rows();
    if (d.size() != n || !d.allFinite()) return "ray is missing or not finite";
    Wide pull = 0, stiffness = 0;
    for (Index i = 0; i < n; ++i) {
        pull += Wide(qp.b[i]) * d[i];
        stiffness = std::max<Wide>(stiffness, std::abs(qp.A(i, i)));
    }
    if (!(pull > 0)) return "ray: b'd <= 0";
    for (Index i = 0; i < n; ++i) {
        Sum force;
        for (Index j = 0; j < n; ++j) force.add(Wide(qp.A(i, j)) * d[j]);
        if (std::abs(force.value) > tolerance * stiffness) return "ray: A d is not zero";
    }
    Wide weight = 0;
    for (Index i = 0; i < m; ++i)
        for (Index j = 0; j < n; ++j) weight = std::max<Wide>(weight, std::abs(qp.B(i, j)));
    for (Index i = 0; i < m; ++i) {
        Sum rate;
        for (Index j = 0; j < n; ++j) rate.add(Wide(qp.B(i, j)) * d[j]);
        if (qp.c[i] != -infinity && rate.value < -tolerance * weight) return "ray: a row stops it";
    }
    return {};
}

/// |A^-1 b|, found in unknowns of unit stiffness; a trifle where A is singular.
inline Vector size_of_free_solution(const QuadraticProgram& qp) {
    const Vector unit = qp.A.diagonal().unaryExpr([](double a) { return a > 0 ? 1 / std::sqrt(a) : 1.0; });
    const DenseMatrix scaled = unit.asDiagonal() * qp.A * unit.asDiagonal();
    const Vector free = unit.cwiseProduct(scaled.fullPivLu().solve(unit.cwiseProduct(qp.b)));
    return free.allFinite() ? Vector(free.cwiseAbs().array() + 1e-20) : Vector(Vector::Constant(free.size(), 1e-20));
}

/// Why the report is not true; empty if it is, or claims nothing (cycling, iteration_limit, inaccurate).
inline std::string fault(const QuadraticProgram& qp, const ContactReport& report, const Vector& u,
                         const Vector& lambda, const Vector& noise) {
    switch (report.outcome) {
        case Outcome::converged: return fault_of_point(qp, u, lambda, noise);
        case Outcome::infeasible:
            return report.infeasibility.size() == 0 ? "" : fault_of_certificate(qp, report.infeasibility);
        case Outcome::unbounded: return report.ray.size() == 0 ? "" : fault_of_ray(qp, report.ray);
        default: return {};
    }
}

}  // namespace tact::laws
