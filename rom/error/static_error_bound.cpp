#include "static_error_bound.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

namespace tact {

StaticErrorBound::StaticErrorBound(const Shared<ContactFamily>& family, const ReducedBasis& basis,
                                   const LinearSolver& linear, const ContactWorkspace& contact)
    : family_(family), U_lambda_(basis.U_lambda) {
    const ContactProblem full = family->at((family->lower() + family->upper()) / 2);
    validate(full);
    validate(basis, full);
    if (!full.is_static() || !full.c.constant() || !full.f.constant() || full.r)
        throw InputError("StaticErrorBound: the problem is not static, linear and constant in time, expected that");
    if (!only_gap_varies(*family))
        throw InputError("StaticErrorBound: more than the gap of the family varies, expected the gap only");
    if (!full.K.is_symmetric()) throw InputError("StaticErrorBound: K is not symmetric, expected that");
    if (basis.signs == DualSigns::any) throw InputError("StaticErrorBound: U_lambda has any sign, expected >= 0");
    rows_.resize(static_cast<std::size_t>(full.constraints()));
    std::iota(rows_.begin(), rows_.end(), Index{0});
    add_lifts(full, contact);
    const Index p = basis.primal_size(), m = basis.dual_size();
    DenseMatrix X(full.size(), p + 1 + 2 * m);
    X.leftCols(p) = basis.U;
    auto forces = X.middleCols(p, 1 + m);
    forces.col(0) = full.f.at(0);
    if (m > 0) forces.rightCols(m) = full.B.transposed_times(U_lambda_);
    linear.factorize(full.K)->solve(forces);
    X.rightCols(m) = W_;
    B_U_ = full.B.times(basis.U);
    B_W_ = full.B.times(W_);
    for (const Index row : rows_)
        if (patch_[static_cast<std::size_t>(row)] >= 0) touched_.push_back(row);
    U_lambda_ = U_lambda_(touched_, Eigen::all).eval();
    work_ = U_lambda_.transpose() * B_W_(touched_, Eigen::all);
    factor_energy(full, X);
}

void StaticErrorBound::add_lifts(const ContactProblem& full, const ContactWorkspace& contact) {
    const Index lifts = U_lambda_.cols(), m = full.constraints();
    patch_.assign(rows_.size(), -1);
    for (const Index row : rows_)
        if (lifts > 0 && U_lambda_.row(row).maxCoeff(&patch_[static_cast<std::size_t>(row)]) == 0)
            patch_[static_cast<std::size_t>(row)] = -1;
    W_.resize(full.size(), lifts);
    ContactProblem lift = full;
    lift.f = Vector(Vector::Zero(full.size()));
    for (Index j = 0; j < lifts; ++j) {
        Vector c = Vector::Zero(m);
        for (const Index row : rows_)
            if (patch_[static_cast<std::size_t>(row)] == j) c[row] = 1;
        lift.c = std::move(c);
        const StaticSolution solution = solve_static(lift, contact);
        if (solution.report.outcome != Outcome::converged)
            throw NumericalError("StaticErrorBound: the lift of column " + std::to_string(j) +
                                 " of U_lambda: " + std::string(to_string(solution.report.outcome)));
        W_.col(j) = solution.u;
    }
}

/// Gram-Schmidt in the inner product of K, twice: energies of differences then lose no digits to squares.
void StaticErrorBound::factor_energy(const ContactProblem& full, const DenseMatrix& X) {
    constexpr double dependent = 1e-14;
    const Index columns = X.cols();
    DenseMatrix Q(X.rows(), 0), KQ(X.rows(), 0);
    energy_ = DenseMatrix::Zero(columns, columns);
    for (Index j = 0; j < columns; ++j) {
        Vector x = X.col(j);
        const double before = std::sqrt(std::max(x.dot(full.K * x), 0.0));
        for (int pass = 0; pass < 2; ++pass) {
            const Vector overlap = KQ.transpose() * x;
            x.noalias() -= Q * overlap;
            energy_.col(j).head(overlap.size()) += overlap;
        }
        Vector Kx = full.K * x;
        const double rest = std::sqrt(std::max(x.dot(Kx), 0.0));
        if (!(rest > dependent * before)) continue;
        const Index k = Q.cols();
        energy_(k, j) = rest;
        for (DenseMatrix* A : {&Q, &KQ}) A->conservativeResize(Eigen::NoChange, k + 1);
        Q.col(k) = x / rest;
        KQ.col(k) = Kx / rest;
    }
    energy_.conservativeResize(Q.cols(), Eigen::NoChange);
}

EnergyBound StaticErrorBound::operator()(const Parameter& gamma, const ConstVectorRef& q,
                                         const ConstVectorRef& s) const {
    const Index p = B_U_.cols(), lifts = W_.cols();
    if (q.size() != p || s.size() != lifts)
        throw InputError("StaticErrorBound: q and s have " + std::to_string(q.size()) + " and " +
                         std::to_string(s.size()) + " entries, expected " + std::to_string(p) + " and " +
                         std::to_string(lifts));
    if (!q.allFinite()) throw InputError("StaticErrorBound: q has a NaN or infinite entry, expected finite entries");
    if (!(s.array() >= 0).all() || !s.allFinite())
        throw InputError("StaticErrorBound: s has a negative, NaN or infinite entry, expected finite s >= 0");
    Vector violation(static_cast<Index>(rows_.size()));
    family_->gap(gamma, rows_, violation);
    if (violation.hasNaN())
        throw InputError("StaticErrorBound: the family's gap has a NaN, expected a number or -inf");
    violation.noalias() -= B_U_ * q;

    EnergyBound bound;
    Vector height = Vector::Zero(lifts);
    for (const Index row : rows_) {
        const Index patch = patch_[static_cast<std::size_t>(row)];
        if (patch >= 0) height[patch] = std::max(height[patch], violation[row]);
        bound.penetration = std::max(bound.penetration, violation[row]);
    }
    if (bound.penetration > 0) {
        // One factor makes the correction as small as all rows allow, and large enough for rows without a lift.
        if (height.isZero(0)) height.setOnes();
        const Vector raised = B_W_ * height;
        double factor = 0;
        for (const Index row : rows_)
            if (violation[row] > 0)
                factor = std::max(factor, raised[row] > 0 ? violation[row] / raised[row] : infinity);
        if (factor == infinity) {
            bound.error = bound.correction = infinity;
            return bound;
        }
        height *= factor;
    }
    Vector rho = Vector::Zero(energy_.cols()), z = rho;
    rho.head(p) = q;
    rho[p] = -1;
    rho.segment(p + 1, lifts) = -s;
    z.tail(lifts) = height;
    const Vector energy_rho = energy_ * rho, energy_z = energy_ * z;
    bound.residual = energy_rho.norm();
    bound.correction = energy_z.norm();
    // s'U_lambda'(B (U q + z) - c). Rows without a multiplier are left out: where they are switched off, 0 times infinity.
    const Vector lambda = U_lambda_ * s;
    const Vector below = violation(touched_);
    const double pressed = (lambda.array() > 0).select(lambda.cwiseProduct(below), 0).sum();
    bound.gap = std::max(0.0, s.dot(work_ * height) - pressed);
    bound.error =
        (energy_z - energy_rho).norm() / 2 + std::sqrt((energy_z + energy_rho).squaredNorm() / 4 + bound.gap);
    return bound;
}

}  // namespace tact
