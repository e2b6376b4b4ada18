// IDA's BDF with variable step and order, contact in every step.
#pragma once

#include <optional>

#include "../../lib/time/integrator.hpp"

namespace tact {

/// SUNDIALS' IDA on y = (u, v): each step solves its implicit stage with the contact conditions on u, through a nonlinear
/// solver of ours, so that its Newton iteration never sees the kink. u is in the error test, v is not: it jumps at
/// impacts, where any tolerance would fail. Order 2 at most by default: higher orders gain energy in impacts (five to
/// thirty-five times the initial one has been seen with order 5); allowed, with a warning in the report.
///
/// As for Bdf2 the impact is resolved by the scheme, at the end of whatever step it falls in. A step ends wherever load
/// or gap jump. Dense output is IDA's interpolant: of u to the method's order, and not admissible within rounding as
/// accepted steps are.
class Ida final : public Integrator {
public:
    struct Options {
        double rtol = 1e-4;
        double atol = 1e-7;            ///< of u, in its units
        int max_order = 2;             ///< from 1 to 5
        double first_step = 0;         ///< 0: IDA's choice
        double max_step = 0;           ///< 0: the grid's whole length
        long most_steps = 10'000'000;  ///< accepted or not; then Outcome::step_limit
        /// SUNDIALS' Newton iteration with a condensed n x n linear solve in place of the stage hook: for scenes without
        /// contact (InputError else). The residuals reported are those of its linear solves: the iteration itself ends at
        /// SUNDIALS' tolerance. Cross-checks the hook; for an r it is one Newton iteration where the hook has two.
        bool newton = false;
        /// An impact law: where rows close, the velocity is projected as by VelocityProjection with this restitution, and
        /// the history begins anew. Nothing: the scheme's own restitution, which depends on the step it falls in.
        std::optional<double> restitution = {};
    };
    Ida() : Ida(Options{}) {}
    /// InputError if an option is out of its range.
    explicit Ida(const Options& options);
    /// Constant-step BDF2 at the grid's dt, through IDA's public interface. Its first two steps are of order 1; from the
    /// third step on it is Bdf2's recurrence to rounding.
    static Ida fixed_step();

    std::string name() const override;
    bool adaptive() const override { return !fixed_; }
    /// InputError for static problems.
    std::unique_ptr<Run> start(const Shared<ContactProblem>& problem, const TimeGrid& grid,
                               const ContactWorkspace& workspace) const override;

private:
    Options options_;
    bool fixed_ = false;
};

}  // namespace tact
