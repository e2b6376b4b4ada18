// What an answer says about its own error.
#pragma once

#include <optional>

#include "../../lib/algebra/linear_solver.hpp"
#include "reduced_model.hpp"

namespace tact {

/// Gathers the indicators P and R of ErrorChecks over the states of one answer after the other. Costs a step of J two products
/// with few rows. One thread at a time.
class ErrorCheck {
public:
    /// Holds the model.
    explicit ErrorCheck(const Shared<ReducedModel>& model);

    /// The next answer: `reduced` is the model's problem at gamma, held until the next.
    void begin(const Parameter& gamma, const Shared<ContactProblem>& reduced);
    /// A state of it; those that are not in J are left out.
    void add(const State& state);

    double penetration() const;
    double residual() const;
    /// Empty where the model has no calibration. Infinite outside the box: nothing was learnt there.
    std::optional<double> estimate() const;

private:
    void add_residual(const State& state);
    Shared<ReducedModel> owned_;
    const ReducedModel& model_ = *owned_;
    Parameter gamma_;
    Shared<ContactProblem> reduced_;
    std::unique_ptr<const Factor> inertia_;  // of M_r, or D_r where there is no M
    Vector gap_, row_, rate_, unknown_, load_;
    double penetration_ = 0, residual_ = 0, size_ = 0;
};

}  // namespace tact
