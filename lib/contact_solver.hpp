// The seam to contact: a recipe, its prepared work on one (A, B), and the report of one solve.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "contact_rows.hpp"
#include "errors.hpp"
#include "kkt.hpp"
#include "problem/matrix.hpp"

namespace tact {

/// Where the solution goes; on entry the guess it starts from. Both stay as they were when the solve fails.
/// lambda = 0 is always a valid guess; u is only read by solvers that say so.
struct ContactPoint {
    VectorRef u;       ///< n
    VectorRef lambda;  ///< m
};

/// How one contact solve ended, and the certificate of what it returned.
struct [[nodiscard]] ContactReport {
    Outcome outcome = Outcome::converged;
    KktResiduals kkt;
    int iterations = 0;              ///< of the active set
    Index active = 0;                ///< rows with a multiplier
    bool set_repeated = false;       ///< an active set came back and the fall-back finished the solve
    std::string_view strategy;       ///< a string with static lifetime: what solved it
    std::string_view fallback = {};  ///< what finished it instead, if anything did
    std::string_view reason = {};    ///< with static lifetime: why a chooser took this strategy
    /// After Outcome::infeasible: y with B'y = 0 and sum c_i y_i > 0 (largest entry 1), m numbers. c_i is the lower bound
    /// where y_i > 0 and the upper one where y_i < 0; contact rows have y_i >= 0.
    Vector infeasibility = {};
    /// After Outcome::unbounded: d with A d = 0, B d >= 0, b'd > 0 (largest entry 1), n numbers.
    Vector ray = {};
    /// What is known of the reason where the outcome is not `converged`; else mostly empty.
    std::string detail = {};
};

/// The common end of a solve: takes the certificate of (u, lambda) and counts the rows in contact; within `tolerance` (for
/// gaps of size `gap_size`) the point takes them, else the outcome is `inaccurate` and the point stays.
void certify(ContactReport& report, const KktCertificate& certificate, const ConstVectorRef& b, const RowBounds& rows,
             const ConstVectorRef& u, const ConstVectorRef& lambda, double tolerance, double gap_size,
             ContactPoint point);
void certify(ContactReport& report, const KktCertificate& certificate, const ConstVectorRef& b,
             const ConstVectorRef& c, const ConstVectorRef& u, const ConstVectorRef& lambda, double tolerance,
             double gap_size, ContactPoint point);

/// Contact solves with one (A, B) and many (b, c). Owns factors, symbolic analyses, cached columns and work space;
/// knows no time. One thread at a time.
class PreparedContact {
public:
    virtual ~PreparedContact() = default;
    /// min 1/2 u'Au - u'b  s.t.  Bu >= c.
    virtual ContactReport solve(const ConstVectorRef& b, const ConstVectorRef& c, ContactPoint point) = 0;
    /// The same for rows of every kind (see RowBounds), by what ContactSolver::prepare_rows made. Here: contact rows as above,
    /// InputError for others.
    virtual ContactReport solve_rows(const ConstVectorRef& b, const RowBounds& rows, ContactPoint point);
    /// Goes on with the numbers of `A`, a matrix with the size and the pattern of the one before, and keeps what does not hang
    /// on numbers: orderings, symbolic analyses, the choice of a strategy, which rows were in contact. True: later solves are
    /// with A. False: this strategy or this A needs a fresh `prepare`, and nothing has changed.
    /// Throws like `prepare`; then nothing has changed either, or every solve throws the same.
    virtual bool update(const Matrix& A);
    /// Whether a good guess of u shortens the solve (an iterative inner solver), or is not even read.
    virtual bool reads_guess() const { return false; }
};

/// An immutable recipe for contact solves.
class ContactSolver {
public:
    virtual ~ContactSolver() = default;
    /// InputError if A and B do not fit or are of a kind this recipe does not take; NumericalError if A is singular.
    virtual std::unique_ptr<PreparedContact> prepare(const Matrix& A, const Matrix& B) const = 0;
    /// The same for solve_rows. Here: InputError, this recipe takes contact rows only.
    virtual std::unique_ptr<PreparedContact> prepare_rows(const Matrix& A, const Matrix& B) const;
};

/// What every prepare asks first: A square with at least one unknown, B with as many columns, both finite. InputError in the
/// name of `solver` otherwise.
void check_contact_matrices(std::string_view solver, const Matrix& A, const Matrix& B);

class LinearSolver;

/// The solver of a scene without contact: one factor, one solve a stage. InputError if B has rows.
class WithoutContact final : public ContactSolver {
public:
    explicit WithoutContact(std::shared_ptr<const LinearSolver> linear);
    std::unique_ptr<PreparedContact> prepare(const Matrix& A, const Matrix& B) const override;

private:
    std::shared_ptr<const LinearSolver> linear_;
};

}  // namespace tact
