// How much a reduced run violates the full contact conditions: what the greedy search maximises.
#pragma once

#include <vector>

#include "../../lib/problem/contact_family.hpp"
#include "../../lib/time/integrator.hpp"
#include "../model/reduced_basis.hpp"

namespace tact {

struct IndicatorWeights {
    double penetration = 1;      ///< alpha_1
    double complementarity = 0;  ///< alpha_2
    double negativity = 0;       ///< alpha_3
};

/// Reduced states at the times of J, a column each.
struct ReducedStates {
    std::vector<double> times;
    DenseMatrix q, v, s;  ///< p, p (without columns unless second order) and p_lambda rows
    Index size() const { return static_cast<Index>(times.size()); }
};

/// Collects the states of one reduced run after the other at the steps of J.
class ReducedStateRecorder {
public:
    /// `steps`: J in ascending order; may name step 0.
    explicit ReducedStateRecorder(std::vector<long> steps);
    /// Starts the next run; the observer lives no longer than this recorder.
    Observer observer(const ContactProblem& reduced);
    const ReducedStates& states() const { return states_; }

private:
    std::vector<long> steps_;
    ReducedStates states_;
};

/// I(gamma) = sum over J of  alpha_1 |[r1]_-|^2 + alpha_2 |r2|^2 + alpha_3 |[r3]_-|^2  (eqs. 14, 15) with
///   r1 = B U q - c,   r3 = (B')^+ (M U a + D U v + K U q - f),   r2 = r3 * r1 entrywise;
/// (B')^+ = (B B')^-1 B and the acceleration a from the reduced balance M_r a = f_r + B_r' s - D_r v - K_r q (without M,
/// the velocity from D_r v = ...). That is the residual A u - b of the stage which ended the step. Rows with
/// c = -infinity count nothing. Units: those of the problem, squared, so the weights depend on its scaling.
class Indicator {
public:
    /// Holds B U (m x p), and up to three such matrices where alpha_2 or alpha_3 is not zero. Only the gap of the family
    /// may depend on gamma, without alpha_2 and alpha_3 all but B. InputError for that and a negative or NaN weight;
    /// NumericalError if (B')^+ is needed and the rows of a sparse B are dependent. Holds the family.
    Indicator(const Shared<ContactFamily>& family, const ReducedBasis& basis, IndicatorWeights weights = {});

    /// `reduced`: the problem at gamma the states come from.
    double operator()(const Parameter& gamma, const ContactProblem& reduced, const ReducedStates& states) const;

private:
    DenseMatrix rates(const ContactProblem& reduced, const ReducedStates& states) const;
    double penetration(const AffineVector& c, const Eigen::Ref<const DenseMatrix>& q,
                       const DenseMatrix& c_coefficients) const;

    Shared<ContactFamily> family_;
    IndicatorWeights weights_;
    bool parametric_;
    std::vector<Index> rows_;      // all of them
    AffineVector c_;               // where there are no parameters
    DenseMatrix B_U_;              // its first modes alone where only penetration counts; then also:
    DenseMatrix U_B_;              // (B U)'
    Vector tail_norm_, row_norm_;  // of the rows of B U, behind the first modes and of all
    Index p_;
    DenseMatrix force_;  // (B')^+ [K U, L U, D U]; L is M, or D in a problem of first order
    AffineVector load_;  // (B')^+ f
};

}  // namespace tact
