#include "impact_ledger.hpp"

#include <algorithm>

namespace tact {
namespace {

/// An approach slower than this fraction of the fastest row is no impact but rounding.
constexpr double slow = 1e-6;

}  // namespace

ImpactLedger::ImpactLedger(const ContactProblem& problem)
    : problem_(problem),
      energy_(problem),
      watch_energy_(energy_.observer()),
      rate_(problem.constraints()),
      free_rate_(Vector::Zero(problem.constraints())),
      closed_(static_cast<std::size_t>(problem.constraints()), 0) {
    if (!problem.second_order()) throw InputError("ImpactLedger: the problem has no M, expected one");
    if (problem.c.constant()) return;
    gap_now_.resize(problem.constraints());
    gap_before_.resize(problem.constraints());
}

void ImpactLedger::record(const State& state, const StepReport& report) {
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

Observer ImpactLedger::observer() {
    return [this](const State& state, const StepReport& report) {
        record(state, report);
        return Flow::proceed;
    };
}

}  // namespace tact
