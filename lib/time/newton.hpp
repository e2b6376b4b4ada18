// Newton's method around contact solves, for stages with internal forces r(u), at the price of a linear stage.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "stage.hpp"

namespace tact {

/// Solves  A u + r(u) = b + B'lambda,  B u >= c,  lambda >= 0,  lambda . (B u - c) = 0  for A = mass M + damping D + stiffness K.
///
/// Each iteration is a contact solve with A + T for a tangent T of r that stays frozen while the residual falls fast:
///   (A + T) u_k+1 = b - r(u_k) + T u_k + B'lambda_k+1.
/// T begins as zero where inertia outweighs r by far (then the solver is that of a linear run), else as r'(u) at the guess.
/// A new tangent r'(u_k) comes, by PreparedContact::update, when the residual falls too slowly, or when the solves that the old
/// one has cost beyond one a stage are worth it. Where a step with a tangent of its own point does not make the residual fall,
/// it is shortened to where r, A and b do no more work along it.
/// It ends on the residual of the equations above, with r evaluated anew at the u that is returned: that is the certificate.
/// A tangent that is wrong costs iterations, at worst the outcome `iteration_limit`; it never changes an answer.
class NewtonSolver {
public:
    /// `problem` has an r and must outlive it.
    NewtonSolver(const ContactProblem& problem, ContactWorkspace workspace);
    ~NewtonSolver();

    /// The point takes u and lambda when the outcome is `converged`. `not_finite` where r or its tangent is; the report's
    /// detail then says which entry, and otherwise what is known of a failure.
    ContactReport solve(const Combination& combination, const ConstVectorRef& b, const RowBounds& rows,
                        ContactPoint point);

private:
    struct Frozen;
    ContactReport iterate(Frozen& at, const ConstVectorRef& b, const RowBounds& rows);
    void take_step();
    Frozen* frozen(const Combination& combination);
    void renew(Frozen& at);
    void put_in(Frozen& at, const Matrix& tangent);
    bool outweighed_by_inertia(const Combination& combination, const Matrix& tangent) const;
    void shorten_step(const Frozen& at, const ConstVectorRef& b);
    std::string what_is_wrong(double residual);

    const ContactProblem& problem_;
    ContactWorkspace workspace_;
    std::vector<std::unique_ptr<Frozen>> frozen_;  // most recent first
    Vector u_, lambda_, force_;                    // the point of the iteration, and r there
    Vector next_u_, next_lambda_, next_force_;     // what the contact solve makes of it
    Vector load_, work_, product_;
    bool fresh_ = false;  // the tangent in use is that of u_, or there is no better one
    std::string fault_;   // what is not finite
};

}  // namespace tact
