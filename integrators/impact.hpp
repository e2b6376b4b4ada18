// The velocity level of schemes that keep the impact law apart from the position constraint.
#pragma once

#include <optional>

#include "../lib/time/stage.hpp"

namespace tact {

/// InputError of `who` unless e is absent or from 0 to 1.
void check_restitution(const char* who, std::optional<double> e);

/// v := argmin |v - w|_M  subject to  B_C v >= c' - e (B_C v_before - c')  on the rows C that the position constraint
/// closed; its multiplier is the impulse P >= 0, so that M (v - w) = B_C' P. Newton's law with restitution e.
///
/// For e > 0, and wherever a scheme has no energy theorem, the safeguard keeps mechanical energy from growing by more
/// than the work of the load (constant gaps only): v moves from its projection towards that with e = 0, as far as the
/// balance asks.
class VelocityProjection {
public:
    /// Holds both. InputError unless 0 <= e <= 1 and the problem has an M.
    VelocityProjection(const Shared<ContactProblem>& problem, const ContactWorkspace& workspace, double restitution,
                       bool energy_theorem);

    /// out = B'lambda, by the rows that press.
    void press(const ConstVectorRef& lambda, VectorRef out) const;
    /// x := (M + damping D)^-1 x: by the lumped diagonal or one factor.
    void solve_mass(double damping, VectorRef x);
    /// From `momentum` = M w, and `next` with u and the position multipliers (> 0: a closed row), its v and, in
    /// lambda, the impulse over h. Without closed rows v = w and lambda = 0.
    ContactReport project(const State& before, const ConstVectorRef& momentum, double h, State& next);
    /// What a step gained in mechanical energy beyond the work of its load (trapezoid rule).
    double excess_energy(const State& before, const State& next);

private:
    void closed_rates(const ConstVectorRef& v, Vector& out) const;
    ContactReport solve(const ConstVectorRef& w, VectorRef v, VectorRef impulse);
    ContactReport keep_energy(const State& before, State& next);

    Shared<ContactProblem> owned_;
    const ContactProblem& problem_ = *owned_;
    ContactWorkspace workspace_;
    double restitution_;
    bool safeguard_;
    Vector inverse_mass_;  // of a diagonal M
    DenseMatrix rows_;     // column i: row i of a dense B
    std::shared_ptr<PreparedContact> mass_, damped_mass_;
    double damping_ = 0;
    Vector closed_, rate_, off_, impulse_, none_, work_, difference_, safe_v_, safe_impulse_;
    Vector bound_, jump_, free_, scratch_;
};

}  // namespace tact
