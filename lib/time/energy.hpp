// Energy of a state and its balance over a march.
#pragma once

#include <vector>

#include "integrator.hpp"

namespace tact {

/// Energies at one time, and the work done since the march began, in the problem's units of force times length.
struct Energy {
    double t = 0;
    double kinetic = 0;        ///< v'Mv / 2
    double strain = 0;         ///< u'Ku / 2, and the potential of r where there is one
    double potential = 0;      ///< -f(t)'u
    double external_work = 0;  ///< sum of (f_k + f_k+1)/2 . (u_k+1 - u_k), one-sided limits inside the step
    double contact_work = 0;   ///< sum of lambda_k+1 . B (u_k+1 - u_k)
    double damping_work = 0;   ///< sum of -(v_k + v_k+1)'/2 D (u_k+1 - u_k)
    /// What the last step created (+) or lost (-): its change of kinetic and strain energy less the work done in it.
    double step_balance = 0;
    double mechanical() const { return kinetic + strain; }
    double total() const { return kinetic + strain + potential; }
};

/// Keeps one Energy per state. Costs one product with K, M, B (and D) a step: leave it out where not wanted. A handle: copies,
/// and the observer, share what is recorded.
class EnergyLedger {
public:
    explicit EnergyLedger(Shared<ContactProblem> problem);
    /// Records into this ledger.
    Observer observer() const;
    const std::vector<Energy>& history() const;

private:
    struct Record;
    std::shared_ptr<Record> record_;
};

/// The energies of a single state (works are zero).
Energy energy_of(const ContactProblem& problem, const State& state);

}  // namespace tact
