#include "impact.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace tact {

void check_restitution(const char* who, std::optional<double> e) {
    if (e && !(*e >= 0 && *e <= 1))
        throw InputError(std::string(who) + ": restitution is " + shown(*e) + ", expected from 0 to 1");
}

VelocityProjection::VelocityProjection(const Shared<ContactProblem>& problem, const ContactWorkspace& workspace,
                                       double restitution, bool energy_theorem)
    : owned_(problem),
      workspace_(workspace),
      restitution_(restitution),
      safeguard_((restitution > 0 || !energy_theorem) && problem->c.constant()),
      closed_(problem->constraints()),
      rate_(Vector::Zero(problem->constraints())),
      off_(Vector::Constant(problem->constraints(), -infinity)),
      impulse_(Vector::Zero(problem->constraints())),
      none_(Vector::Zero(problem->constraints())),
      work_(problem->size()),
      difference_(problem->size()),
      safe_v_(problem->size()),
      safe_impulse_(problem->constraints()),
      bound_(problem->constraints()),
      jump_(problem->size()),
      free_(problem->size()),
      scratch_(std::max(problem->c.mode_count(), problem->f.mode_count())) {
    check_restitution("VelocityProjection", restitution);
    require_contact_rows("an impact law", *problem);
    if (!problem->M) throw InputError("VelocityProjection: the problem has no M, expected one");
    // No force gives a massless unknown a velocity: it is 0 but for what the rows make of it.
    if (const Vector* m = problem->M->diagonal_entries())
        inverse_mass_ = m->unaryExpr([](double mass) { return mass == 0 ? 0 : 1 / mass; });
    if (const DenseMatrix* B = problem->B.dense()) rows_ = B->transpose();
}

void VelocityProjection::press(const ConstVectorRef& lambda, VectorRef out) const {
    if (rows_.size() == 0) return problem_.B.multiply_transposed(lambda, out);
    out.setZero();
    for (Index i = 0; i < lambda.size(); ++i)
        if (lambda[i] != 0) out += lambda[i] * rows_.col(i);
}

void VelocityProjection::solve_mass(double damping, VectorRef x) {
    const bool damped = damping != 0 && problem_.D;
    if (!damped && inverse_mass_.size() > 0) {
        x.array() *= inverse_mass_.array();
        return;
    }
    // A contact solve with every row switched off.
    std::shared_ptr<PreparedContact>& prepared = damped ? damped_mass_ : mass_;
    if (!prepared || (damped && damping != damping_)) {
        prepared = workspace_.prepared(problem_, {1, damped ? damping : 0, 0});
        if (damped) damping_ = damping;
    }
    work_ = x;
    none_.setZero();
    const ContactReport report = prepared->solve(work_, off_, {x, none_});
    if (report.outcome != Outcome::converged)
        throw NumericalError("VelocityProjection: the solve with M ended " + std::string(to_string(report.outcome)));
}

/// B v where closed_ is finite, anything elsewhere: a dense B has few rows to be read then.
void VelocityProjection::closed_rates(const ConstVectorRef& v, Vector& out) const {
    if (rows_.size() == 0) return problem_.B.multiply(v, out);
    for (Index i = 0; i < out.size(); ++i) out[i] = closed_[i] > -infinity ? rows_.col(i).dot(v) : 0;
}

ContactReport VelocityProjection::solve(const ConstVectorRef& w, VectorRef v, VectorRef impulse) {
    if (!mass_) mass_ = workspace_.prepared(problem_, {1, 0, 0});
    // For the jump v - w: its size is the impact's, so that residuals mean something where the rows leave v = 0 only.
    closed_rates(w, bound_);
    bound_ = closed_ - bound_;
    work_.setZero();
    jump_ = v - w;
    const ContactReport report = mass_->solve(work_, bound_, {jump_, impulse});
    if (report.outcome == Outcome::converged) v = w + jump_;
    return report;
}

ContactReport VelocityProjection::project(const State& before, const ConstVectorRef& momentum, double h,
                                          State& next) {
    if (!(next.lambda.array() > 0).any()) {
        next.v() = momentum;
        solve_mass(0, next.v());
        next.lambda.setZero();
        return {};
    }
    if (!problem_.c.constant()) {
        problem_.c.evaluate(next.t, Side::right, scratch_, closed_);
        problem_.c.evaluate(before.t, Side::right, scratch_, rate_);
        rate_ = (closed_ - rate_) / h;
    }
    if (restitution_ > 0) {
        closed_ = (next.lambda.array() > 0).select(rate_, off_);
        closed_rates(before.v(), bound_);
        // A row that already opens before the impact is not pulled back by it.
        bound_ = rate_ - restitution_ * (bound_ - rate_).cwiseMin(0.0);
        closed_ = (next.lambda.array() > 0).select(bound_, off_);
    } else {
        closed_ = (next.lambda.array() > 0).select(rate_, off_);
    }
    impulse_ = (next.lambda.array() > 0).select(impulse_, 0.0);
    free_ = momentum;
    solve_mass(0, free_);
    next.v() = before.v();
    ContactReport report = solve(free_, next.v(), impulse_);
    if (report.outcome != Outcome::converged) return report;
    if (safeguard_) {
        const ContactReport kept = keep_energy(before, next);
        if (kept.outcome != Outcome::converged) return kept;
        report.kkt.raise_to(kept.kkt);
    }
    next.lambda = impulse_ / h;
    return report;
}

double VelocityProjection::excess_energy(const State& before, const State& next) {
    const ContactProblem& p = problem_;
    difference_ = next.u() - before.u();
    work_ = next.u() + before.u();
    p.K.multiply(work_, safe_v_);
    double excess = 0.5 * difference_.dot(safe_v_);
    if (p.r && p.r->energy) excess += p.r->energy(next.u()) - p.r->energy(before.u());
    p.f.evaluate(before.t, Side::right, scratch_, work_);
    p.f.evaluate(next.t, Side::left, scratch_, safe_v_);
    excess -= 0.5 * (work_ + safe_v_).dot(difference_);
    difference_ = next.v() - before.v();
    work_ = next.v() + before.v();
    p.M->multiply(work_, safe_v_);
    return excess + 0.5 * difference_.dot(safe_v_);
}

ContactReport VelocityProjection::keep_energy(const State& before, State& next) {
    const double excess = excess_energy(before, next);
    if (!(excess > 0)) return {};
    closed_ = (next.lambda.array() > 0).select(rate_, off_);
    safe_v_ = next.v();
    safe_impulse_ = impulse_;
    ContactReport report = solve(free_, safe_v_, safe_impulse_);
    if (report.outcome != Outcome::converged) return report;
    // |d|^2 theta^2 / 2 + v'M d theta + excess = 0, the smaller root; where there is none, the energy's least.
    difference_ = safe_v_ - next.v();
    problem_.M->multiply(difference_, work_);
    const double square = difference_.dot(work_), slope = next.v().dot(work_);
    if (!(square > 0)) return report;
    const double discriminant = slope * slope - 2 * square * excess;
    const double root = (-slope - std::sqrt(std::max(discriminant, 0.0))) / square;
    const double theta = std::clamp(root, 0.0, 1.0);
    next.v() += theta * difference_;
    impulse_ += theta * (safe_impulse_ - impulse_);
    return report;
}

}  // namespace tact
