// One integrator with one step length or tolerance on one scene: its time, and what it made of the motion.
#pragma once

#include <string>
#include <vector>

#include "../../../lib/time/impact_ledger.hpp"
#include "../../../lib/time/integrator.hpp"
#include "../../harness/machine.hpp"
#include "work_precision_scenes.hpp"

namespace tact::bench {

/// An integrator of bench/methods.hpp with a dt or a tolerance to be chosen.
struct PrecisionMethod {
    std::string name;  ///< as bench::integrator takes it
    bool adaptive = false;
    /// Whether lambda is the mean over the step (an impulse over its length), or the force at its end.
    bool mean_force = false;
    bool explicit_steps = false;  ///< stable up to a largest step only

    std::string label() const { return adaptive && name.rfind("ida", 0) != 0 ? name + ", adaptive" : name; }
    /// Whether it is a variant whose impact law is an option.
    bool has_impact_law() const { return name.find(":e=") != std::string::npos; }
    Shared<Integrator> make(double tolerance) const;
};
/// All; those with an impact law as an option last.
const std::vector<PrecisionMethod>& precision_methods();
/// Without those where nothing meets, and explicit ones where M is wanting.
std::vector<PrecisionMethod> precision_methods_for(const PrecisionScene& scene);
/// What a method is asked with: the scene's tolerances, or numbers of steps; explicit methods begin a per cent
/// below their largest step, and double as often.
std::vector<double> parameters_of(const PrecisionMethod& method, const PrecisionScene& scene);

/// The states of one march at the output times, and its ledgers where they were wanted.
struct Recorded {
    Outcome outcome = Outcome::converged;
    std::string detail;  ///< of a failure
    long steps = 0;
    double seconds = 0;  ///< CPU, of the steps alone: what watches them is not in it
    DenseMatrix u;
    Vector impulse;
    double energy_drift = 0;  ///< (energy at the end - work of load and damping - energy at first) / largest energy
    ImpactSummary impacts;
};
enum class Ledgers { none, kept };
/// `parameter`: a number of steps, or a tolerance.
/// Outcome::stopped where `limit` CPU seconds are over.
Recorded record(const PrecisionMethod& method, double parameter, const PrecisionScene& scene, Ledgers ledgers,
                double limit = infinity);

/// As error_u and error_lambda of the rows: see run_work_precision.
double error_u(const PrecisionScene& scene, const DenseMatrix& u, const Reference& reference);
double error_lambda(const Vector& impulse, const Reference& reference);

struct PrecisionTiming {
    int repeats = 5;
    double enough = 2;  ///< CPU s after which no repeat is begun; a recorded march this long is its own timing
    double limit = 20;  ///< CPU s after which a march is given up
};
Json precision_row(const PrecisionScene& scene, const PrecisionMethod& method, double parameter,
                   const PrecisionTiming& timing);
/// Of a march that was not tried, since the one before already took too long.
Json untried_row(const PrecisionScene& scene, const PrecisionMethod& method, double parameter);
/// A row with everything null but the first three.
Json empty_precision_row(const PrecisionScene& scene, const std::string& integrator, const std::string& parameter);

}  // namespace tact::bench
