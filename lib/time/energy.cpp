#include "energy.hpp"

#include <utility>

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

struct EnergyLedger::Record {
    explicit Record(Shared<ContactProblem> owned)
        : problem(std::move(owned)),
          work(problem->size()),
          gap_rate(problem->constraints()),
          load_left(problem->size()),
          load_right(problem->size()),
          scratch(problem->f.mode_count()) {}

    void add(const State& state);

    Shared<ContactProblem> problem;
    std::vector<Energy> history;
    Vector u, v, work, gap_rate, load_left, load_right, scratch;
};

void EnergyLedger::Record::add(const State& state) {
    const ContactProblem& p = *problem;
    Energy e = energy_of(p, state);
    if (!history.empty()) {
        const Energy& last = history.back();
        const Vector du = state.u() - u;
        p.f.evaluate(last.t, Side::right, scratch, load_left);
        p.f.evaluate(state.t, Side::left, scratch, load_right);
        const double external = 0.5 * (load_left + load_right).dot(du);
        double contact = 0, damping = 0;
        if (p.constraints() > 0) {
            p.B.multiply(du, gap_rate);
            contact = state.lambda.dot(gap_rate);
        }
        if (p.D && p.second_order()) {
            p.D->multiply(du, work);
            damping = -0.5 * (v + state.v()).dot(work);
        }
        e.external_work = last.external_work + external;
        e.contact_work = last.contact_work + contact;
        e.damping_work = last.damping_work + damping;
        e.step_balance = e.mechanical() - last.mechanical() - external - contact - damping;
    }
    u = state.u();
    v = state.v();
    history.push_back(e);
}

EnergyLedger::EnergyLedger(Shared<ContactProblem> problem) : record_(std::make_shared<Record>(std::move(problem))) {}

const std::vector<Energy>& EnergyLedger::history() const { return record_->history; }

Observer EnergyLedger::observer() const {
    return [record = record_](const State& state, const StepReport&) {
        record->add(state);
        return Flow::proceed;
    };
}

}  // namespace tact
