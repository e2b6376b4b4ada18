// y' at a given state: what explicit stages and the start of a multistep method need.
#pragma once

#include "../lib/time/stage.hpp"

namespace tact {

/// M v' = f - K u - r(u) - D v + B_C' mu, where the rows C that are closed and not opening keep B_C v' >= 0, mu >= 0; for
/// problems of first order D u' = f - K u - r(u) + B_C' mu with B_C u' >= 0.
class Derivative {
public:
    /// Holds both.
    Derivative(const Shared<ContactProblem>& problem, const ContactWorkspace& workspace);
    /// out = y' at (t, y), t from the right. NumericalError if the contact solve does not converge.
    void operator()(double t, const ConstVectorRef& y, VectorRef out);
    /// mu of the last evaluation, m numbers.
    const Vector& multipliers() const { return mu_; }

private:
    Shared<ContactProblem> owned_;
    const ContactProblem& problem_ = *owned_;
    ContactWorkspace workspace_;
    StageSolver stages_;
    Vector force_, work_, gap_, rate_, bound_, mu_, solution_, scratch_;
};

}  // namespace tact
