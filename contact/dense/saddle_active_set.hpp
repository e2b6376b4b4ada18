// Contact on a few rows of a body with soft or free modes: a dense saddle, no stiffness in its inverse.
#pragma once

#include <cstdint>
#include <vector>

#include "../../lib/errors.hpp"
#include "schur_factor.hpp"

namespace tact {

/// Finds lambda >= 0 and tau with
///   w = S lambda + G tau - g >= 0,   lambda . w = 0,   G'lambda - diag(stiffness) tau = e
/// for S symmetric positive semidefinite with unit diagonal (m x m), G (m x k, k few), stiffness >= 0: the contact problem of
/// a body whose soft motions tau are kept apart, so that a stiffness of zero is as good as any other.
///
/// First the primal-dual active set (M. Hintermueller, K. Ito, K. Kunisch, SIAM J. Optim. 13 (2002) 865-888) from the rows of
/// the guess, or from all of them. Where that does not end, the dual active set of Goldfarb and Idnani (Math. Prog. 27
/// (1983) 1-33), begun at rows that hold all modes without stiffness and balance e: then the problem on the rows in contact
/// always has one solution. A row whose departure would set a mode free changes places with the one that enters, as in the
/// dual simplex method; where steps have length zero rows are taken in the order of their numbers (R. G. Bland, Math. Oper.
/// Res. 2 (1977) 103-107), so that it ends.
class SaddleActiveSet {
public:
    struct [[nodiscard]] Report {
        Outcome outcome = Outcome::converged;
        int iterations = 0;
        bool repeated = false;  ///< the first method did not end
    };
    struct Problem {
        const DenseMatrix& S;  ///< leading block as large as g
        const DenseMatrix& G;
        const Vector& stiffness;
        const Vector& e;
        const Vector& e_size;  ///< of the terms that e is the sum of: below 1e-11 of it a force is rounding
        const Vector& g;
        const Vector& allowance;  ///< row i counts as violated where w_i < -allowance_i
    };

    /// lambda: on entry the guess; on a converged exit lambda, tau and w are the solution.
    Report solve(const Problem& p, Vector& lambda, Vector& tau, Vector& w);
    /// S has changed under the factor.
    void forget() { factor_.clear(); }
    /// The solution of the equations on the rows of the last converged solve, for another g and e:
    /// S lambda + G tau = g on these rows, G'lambda - diag(stiffness) tau = e. lambda is zero on the other rows.
    void solve_on_last_rows(const Problem& p, Vector& lambda, Vector& tau);
    /// After Outcome::infeasible: y >= 0 with S y = 0, G'y = 0 and g'y > 0.
    const Vector& infeasibility() const { return certificate_; }
    /// After Outcome::unbounded: tau with G tau >= 0, stiffness tau = 0 and e'tau < 0.
    const Vector& ray() const { return certificate_; }

private:
    Outcome primal_dual(const Problem& p, Vector& lambda, Vector& tau, Vector& w, Report& report);
    Outcome dual(const Problem& p, Vector& lambda, Vector& tau, Vector& w, Report& report);
    void move_rows_apart(const Problem& p, Vector& lambda, Vector& tau, Vector& w, Report& report);
    void drop_rounding(const Problem& p, Vector& lambda, const Vector& tau, Vector& w) const;
    /// A set of rows that holds every mode without stiffness, with multipliers that balance e.
    Outcome start(const Problem& p, std::vector<Index>& rows);
    /// After the rows in the factor have changed.
    void take_modes(const Problem& p);
    Vector modes_solved(const Vector& f) const;
    /// multiplier_ and tau of the rows in the factor, refined; noise_ is what the last correction changed.
    void solve_equations(const Problem& p, Vector& tau);
    void solve_once(Vector& q, Vector& e) const;
    void gaps(const Problem& p, const Vector& tau, Vector& w);
    double imbalance(const Problem& p, const Vector& tau) const;
    void spread(Vector& lambda) const;
    Outcome enter(const Problem& p, Index q, bool by_number, const Vector& w, Report& report, double& moved);
    Outcome nothing_moves(const Problem& p, Index q, double multiplier_q, const Vector& r, double violation);
    Index first_to_leave(const Vector& r, bool by_number, double& step) const;
    bool sets_a_mode_free(Index place) const;
    Index most_violated(const Problem& p, const Vector& w, bool by_number) const;

    SchurFactor factor_;
    DenseMatrix Y_, H_;    // L^-1 G and Y'Y + diag(stiffness)
    bool holds_ = false;   // H is regular
    bool held_ = false;    // the gaps on the rows in the factor are closed
    DenseMatrix inverse_;  // of H, a pseudo-inverse where it is not
    std::vector<double> multiplier_;
    std::vector<Index> forgiven_;   // violated by rounding alone
    std::vector<Index> postponed_;  // to enter after others
    double noise_ = 0;
    Vector certificate_;
};

}  // namespace tact
