// What impacts did: observed restitution, energy gained and lost.
#pragma once

#include <vector>

#include "energy.hpp"

namespace tact {

/// Over a march so far.
struct ImpactSummary {
    long impacts = 0;            ///< contact intervals of single rows that began with an approach and have ended
    double restitution_min = 0;  ///< of -gap rate after / gap rate before; both 0 without impacts
    double restitution_max = 0;
    double energy_gained =
        0;                   ///< sum of what steps in contact created: (kinetic + strain) less the work of load and D
    double energy_lost = 0;  ///< and of what they took away, as a positive number
    double largest_gain = 0;  ///< in one step
};

/// Watches the gap rates B v - c' of rows that close and open again, and the energy of steps in contact. Costs products
/// with B, M, K a step: leave it out where not wanted. Second order only. A handle: copies, and the observer, share what is
/// recorded.
class ImpactLedger {
public:
    /// InputError without M.
    explicit ImpactLedger(Shared<ContactProblem> problem);
    /// Records into this ledger.
    Observer observer() const;
    const ImpactSummary& summary() const;

private:
    class Record;
    std::shared_ptr<Record> record_;
};

}  // namespace tact
