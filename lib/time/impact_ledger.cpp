#include "impact_ledger.hpp"

#include <algorithm>

namespace tact {
namespace {

/// An approach slower than this fraction of the fastest row is no impact but rounding.
constexpr double slow = 1e-6;

}  // namespace

class ImpactLedger::Record {
public:
    explicit Record(const Shared<ContactProblem>& problem)
        : owned_(problem),
          energy_(problem),
          watch_energy_(energy_.observer()),
          rate_(problem_.constraints()),
          free_rate_(Vector::Zero(problem_.constraints())),
          closed_(static_cast<std::size_t>(problem_.constraints()), 0) {
        if (!problem_.second_order()) throw InputError("ImpactLedger: the problem has no M, expected one");
        if (problem_.c.constant()) return;
        gap_now_.resize(problem_.constraints());
        gap_before_.resize(problem_.constraints());
    }

    void add(const State& state, const StepReport& report);
    const ImpactSummary& summary() const { return summary_; }

private:
    Shared<ContactProblem> owned_;
    const ContactProblem& problem_ = *owned_;
    EnergyLedger energy_;
    Observer watch_energy_;
    ImpactSummary summary_;
    double before_t_ = 0;
    Vector rate_, free_rate_, gap_now_, gap_before_;
    std::vector<char> closed_;
};

void ImpactLedger::Record::add(const State& state, const StepReport& report) {
    (void)watch_energy_(state, report);
    if (state.step > 0 && report.contact.active > 0) {
        // The balance counts the contact force's work as given; here what it took or gave is the impact's.
        const auto& history = energy_.history();
        const Energy &now = history.back(), &last = history[history.size() - 2];
        const double change = now.step_balance + now.contact_work - last.contact_work;
        (change > 0 ? summary_.energy_gained : summary_.energy_lost) += std::abs(change);
        summary_.largest_gain = std::max(summary_.largest_gain, change);
    }
    problem_.B.multiply(state.v(), rate_);
    if (!problem_.c.constant()) {
        gap_now_ = problem_.c.at(state.t);
        if (state.t > before_t_) rate_ -= (gap_now_ - gap_before_) / (state.t - before_t_);
        gap_before_.swap(gap_now_);
    }
    before_t_ = state.t;
    const double fast = rate_.size() > 0 ? rate_.lpNorm<Eigen::Infinity>() : 0;
    for (Index i = 0; i < rate_.size(); ++i) {
        char& closed = closed_[static_cast<std::size_t>(i)];
        if (state.lambda[i] > 0) {
            closed = 1;
            continue;
        }
        if (closed && free_rate_[i] < -slow * fast) {
            const double e = -rate_[i] / free_rate_[i];
            summary_.restitution_min = summary_.impacts == 0 ? e : std::min(summary_.restitution_min, e);
            summary_.restitution_max = summary_.impacts == 0 ? e : std::max(summary_.restitution_max, e);
            ++summary_.impacts;
        }
        closed = 0;
        free_rate_[i] = rate_[i];
    }
}

ImpactLedger::ImpactLedger(Shared<ContactProblem> problem) : record_(std::make_shared<Record>(problem)) {}

const ImpactSummary& ImpactLedger::summary() const { return record_->summary(); }

Observer ImpactLedger::observer() const {
    return [record = record_](const State& state, const StepReport& report) {
        record->add(state, report);
        return Flow::proceed;
    };
}

}  // namespace tact
