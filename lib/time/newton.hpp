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
/// It ends when the load of the last solve is that of the equations above to what that solve left itself, or to 64 roundings of
/// the largest entry of b and r(u). The
/// certificate is that of these equations, with r evaluated anew at the u that is returned. A tangent that is wrong costs iterations, at worst the outcome `iteration_limit`; it never changes an answer.
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
    ContactReport iterate(Frozen& at, const ConstVectorRef& b, const RowBounds& rows, ContactPoint point);
    void move_to(const ConstVectorRef& next);
    double change_of_load(const Frozen& at, double loads, const ConstVectorRef& u);
    Frozen* frozen(const Combination& combination);
    void renew(Frozen& at);
    void put_in(Frozen& at, const Matrix& tangent);
    void leave_out_tangent(Frozen& at);
    bool outweighed_by_inertia(const Combination& combination, const Matrix& tangent) const;
    void shorten_step(const Frozen& at, const ConstVectorRef& b, VectorRef next);
    std::string what_is_wrong(const ContactReport& report, double loads, int solves, const ConstVectorRef& u);

    const ContactProblem& problem_;
    ContactWorkspace workspace_;
    std::vector<std::unique_ptr<Frozen>> frozen_;  // most recent first
    Vector start_u_, start_lambda_;  // what a failed solve gives back; u only once the iteration has moved
    Vector u_, force_, next_force_;  // the point of the iteration, r there and at the next one
    Vector load_, work_, product_;
    bool moved_ = false;
    bool fresh_ = false;  // the tangent in use is that of u_, or there is no better one
    std::string fault_;   // what is not finite
};

}  // namespace tact
