// ARKODE's diagonally implicit Runge-Kutta methods, contact in every stage.
#pragma once

#include <optional>

#include "../../lib/time/integrator.hpp"
#include "butcher_table.hpp"

namespace tact {

/// SUNDIALS' ARKStep on y = (u, v): every implicit stage is solved with the contact conditions on u, through a nonlinear
/// solver of ours, and its slope deduced from the solution, contact forces included. Fixed steps of the grid's dt, or
/// steps chosen to rtol and atol of u, one of which ends wherever load or gap jump; v is not in the error test: it jumps at
/// impacts. The reported lambda is that of the last stage, whose sum over the steps is no impulse.
///
/// Orders as the table's in smooth motion. With the constraint on the position, impacts may gain energy (a single mass on
/// a stop: up to 2 times with SDIRK2, 4.5 with TR-BDF2; many small nodal masses average it, or see redistribute_mass).
/// Under contact the table must be stiffly accurate, so that the accepted state is a stage; an explicit first stage costs
/// one solve with M in the steps that do not start from the last stage.
class Arkode final : public Integrator {
public:
    struct Options {
        double rtol = 1e-4;
        double atol = 1e-7;            ///< of u, in its units
        double first_step = 0;         ///< 0: 1e-3 of the grid's length
        double max_step = 0;           ///< 0: the grid's whole length
        long most_steps = 10'000'000;  ///< accepted or not; then Outcome::step_limit
        /// As Ida's: SUNDIALS' Newton iteration with a condensed linear solve; for scenes without contact. The residuals
        /// reported are those of its linear solves.
        bool newton = false;
        /// An impact law: in steps that end in contact the velocity that the stages' contact forces gave is replaced by a
        /// projection with this restitution (VelocityProjection). Nothing: what the stages gave.
        std::optional<double> restitution = {};
    };
    /// Fixed steps. InputError for a table that validate rejects, or a restitution outside [0, 1].
    explicit Arkode(ButcherTable table, std::optional<double> restitution = {});
    /// Adaptive steps. InputError also if the table has no embedding, or an option is out of its range.
    Arkode(ButcherTable table, const Options& options);

    std::string name() const override;
    bool adaptive() const override { return adaptive_; }
    /// InputError for static problems, and under contact if the table is not stiffly accurate.
    std::unique_ptr<Run> start(const Shared<ContactProblem>& problem, const TimeGrid& grid,
                               const ContactWorkspace& workspace) const override;

private:
    ButcherTable table_;
    Options options_;
    bool adaptive_;
};

}  // namespace tact
