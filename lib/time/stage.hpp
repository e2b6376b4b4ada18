// One implicit stage of any integrator, contact included, and the work shared between stages and between runs.
#pragma once

#include <iosfwd>
#include <memory>

#include "../contact_solver.hpp"
#include "../problem/contact_problem.hpp"
#include "../shared.hpp"

namespace tact {

/// y' = a y + b with y = (u, v): what every implicit method asks of the physics at time t. Static: a = 0.
struct Stage {
    double t = 0;
    double a = 0;
    ConstVectorRef b_u;  ///< n
    ConstVectorRef b_v;  ///< n; empty for problems that are not second order
};

/// The unknowns at one time. y = (u, v) in one piece, u alone unless the problem is second order.
struct State {
    double t = 0;
    long step = 0;
    Vector y;
    Vector lambda;  ///< m; where an impact law is used, its impulse over the step's length
    Index n = 0;

    State() = default;
    explicit State(const ContactProblem& problem, double t0 = 0);
    auto u() const { return y.head(n); }
    auto u() { return y.head(n); }
    auto v() const { return y.tail(y.size() - n); }
    auto v() { return y.tail(y.size() - n); }
};

/// mass M + damping D + stiffness K, of what a problem has.
struct Combination {
    double mass = 0, damping = 0, stiffness = 1;
    bool operator==(const Combination&) const = default;
};
Matrix combined(const ContactProblem& problem, const Combination& combination);
/// The solver's prepare for A and the problem's rows, of whatever kind they are.
std::unique_ptr<PreparedContact> prepare_contact(const ContactSolver& solver, const Matrix& A,
                                                 const ContactProblem& problem);

/// Prepared contact solves, kept by the identity of M, D, K, B and the combination. Hand one workspace to the
/// successive problems of a family, or to run after run, and they share factors, symbolic analyses and cached
/// columns. Keeps the `capacity` most recently used. A handle: copies share what is kept, and a run holds one of them. One
/// thread at a time, copies included.
class ContactWorkspace {
public:
    /// InputError if `solver` is null.
    explicit ContactWorkspace(Shared<ContactSolver> solver, std::size_t capacity = 4);

    /// The combined matrix, prepared with B; stays alive while its user holds it, evicted or not.
    std::shared_ptr<PreparedContact> prepared(const ContactProblem& problem, const Combination& combination) const;
    const ContactSolver& solver() const;

private:
    struct Entry;
    struct Kept;
    std::shared_ptr<Kept> kept_;
};

class NewtonSolver;

/// Solves stages of one problem:
///   (a^2 M + a D + K) u + r(u) = f(t) - M (b_v + a b_u) - D b_u + B' lambda,  contact conditions on u;  v = a u + b_u.
/// Where there is an r, by Newton's method around the contact solve (newton.hpp); the certificate is that of the equations
/// above. Allocates only in its constructor, when the combination changes, and for tangents of r.
/// A load, a gap or an r(u) that is NaN or infinite ends `not_finite`, and the report's detail names it, its time and entry.
/// NumericalError where no strategy takes the combined matrix; it names the matrix of K, M, D that is at fault, if one is.
class StageSolver {
public:
    /// Holds both.
    StageSolver(Shared<ContactProblem> problem, ContactWorkspace workspace);
    ~StageSolver();

    /// On entry `state` holds the guess, on a converged exit the solution at stage.t; else it is untouched.
    ContactReport solve(const Stage& stage, State& state);
    /// A u + r(u) = rhs + B' lambda, B u >= c(t), for another combination A than a stage's.
    ContactReport solve(const Combination& combination, double t, const ConstVectorRef& rhs, ContactPoint point);
    /// f(t), one of its limits where it jumps. Valid until the next call of this object.
    const Vector& load(double t, Side side);
    /// Whether the last prepared contact solver profits from a guess of u.
    bool reads_guess() const { return newton_ || (prepared_ && prepared_->reads_guess()); }

private:
    RowBounds rows() const;
    void read_gap(double t);
    void explain(const Combination& combination, double t, const ConstVectorRef& rhs, ContactReport& report);

    Shared<ContactProblem> owned_;
    const ContactProblem& problem_ = *owned_;
    ContactWorkspace workspace_;
    std::shared_ptr<PreparedContact> prepared_;
    Combination combination_;
    std::unique_ptr<NewtonSolver> newton_;  // where there is an r
    bool load_fails_ = false;               // what was evaluated last is not finite
    bool gap_fails_ = false, upper_fails_ = false;
    Vector load_, gap_, upper_, rhs_, work_, scratch_;
};

/// The equilibrium under contact: the a = 0 stage.
struct [[nodiscard]] StaticSolution {
    Vector u, lambda;
    ContactReport report;
};
/// `guess`: a previous solution to start from. validate(problem) first; InputError also unless the problem is static, and
/// where an empty row of B asks for what no u can give.
StaticSolution solve_static(const ContactProblem& problem, const ContactWorkspace& workspace,
                            const StaticSolution* guess = nullptr);

/// One line where all is well; else also what was tried and what to try.
std::ostream& operator<<(std::ostream& out, const ContactReport& report);
std::ostream& operator<<(std::ostream& out, const StaticSolution& solution);

}  // namespace tact
