#include "energy.hpp"

namespace tact {

Energy energy_of(const ContactProblem& p, const State& state) {
    Energy e;
    e.t = state.t;
    Vector work(p.size());
    p.K.multiply(state.u(), work);
    e.strain = 0.5 * state.u().dot(work);
    if (p.r && p.r->energy) e.strain += p.r->energy(state.u());
    if (p.second_order()) {
        p.M->multiply(state.v(), work);
        e.kinetic = 0.5 * state.v().dot(work);
    }
    e.potential = -p.f.at(state.t).dot(state.u());
    return e;
}

EnergyLedger::EnergyLedger(const ContactProblem& problem)
    : problem_(problem),
      work_(problem.size()),
      gap_rate_(problem.constraints()),
      load_left_(problem.size()),
      load_right_(problem.size()),
      scratch_(problem.f.mode_count()) {}

void EnergyLedger::record(const State& state) {
    Energy e = energy_of(problem_, state);
    if (!history_.empty()) {
        const Energy& last = history_.back();
        const Vector du = state.u() - u_;
        problem_.f.evaluate(last.t, Side::right, scratch_, load_left_);
        problem_.f.evaluate(state.t, Side::left, scratch_, load_right_);
        const double external = 0.5 * (load_left_ + load_right_).dot(du);
        double contact = 0, damping = 0;
        if (problem_.constraints() > 0) {
            problem_.B.multiply(du, gap_rate_);
            contact = state.lambda.dot(gap_rate_);
        }
        if (problem_.D && problem_.second_order()) {
            problem_.D->multiply(du, work_);
            damping = -0.5 * (v_ + state.v()).dot(work_);
        }
        e.external_work = last.external_work + external;
        e.contact_work = last.contact_work + contact;
        e.damping_work = last.damping_work + damping;
        e.step_balance = e.mechanical() - last.mechanical() - external - contact - damping;
    }
    u_ = state.u();
    v_ = state.v();
    history_.push_back(e);
}

Observer EnergyLedger::observer() {
    return [this](const State& state, const StepReport&) {
        record(state);
        return Flow::proceed;
    };
}

}  // namespace tact
