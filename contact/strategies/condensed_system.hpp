// The equations of one active set in one sparse pattern for all sets, refactored by KLU.
#pragma once

#include <optional>
#include <vector>

#include "../../lib/sparse/klu_solver.hpp"
#include "../prepare/rows.hpp"

namespace tact {

/// Unknowns: u, and mu_i for the rows without an unknown of their own.
///   active row i with own unknown o:   row o:      B_i u = c_i
///                                      row j:      A_j u - (B_ij/B_io) A_o u = b_j - (B_ij/B_io) b_o,  j in row i
///   row i without:                     row n + k:  B_i u = c_i (active) or mu_i = 0;   A u - B_i' mu_i in the rows of u
class CondensedSystem {
public:
    using Set = std::vector<char>;  ///< of the rows: whether active

    /// `rows` must outlive the system.
    CondensedSystem(const SparseMatrix& A, const ConstraintRows& rows);

    /// Other numbers on the same pattern; false, and nothing done, where the pattern is another one.
    [[nodiscard]] bool take(const SparseMatrix& A);

    /// Refactors for this set, unless it is the one factored last; false if its equations are singular.
    [[nodiscard]] bool factor(const Set& active);
    /// Solves on the set last factored. size_i: of the terms that lambda_i is a sum of, so that some 1e-16 of it is rounding.
    void solve(const ConstVectorRef& b, const ConstVectorRef& c, const Set& active, Vector& u, Vector& lambda,
               Vector& size);

    /// A by rows: column i holds row i.
    const SparseMatrix& by_row() const { return by_row_; }
    /// Operations of one numeric factorisation and of one solve, as KLU counts them.
    double factor_cost() const { return klu_->factor_cost(); }
    double solve_cost() const { return klu_->solve_cost(); }

private:
    double weight_of(Index row, Index column) const;
    std::vector<Index> find_own_unknowns();
    SparseMatrix pattern();
    double& at(Index row, Index column);
    void add_row(Index target, Index source, double factor);
    double force(Index row, const ConstVectorRef& b, const Vector& u, double& size) const;

    const ConstraintRows& rows_;
    Index n_;
    Index extras_ = 0;
    SparseMatrix by_row_;
    std::vector<long> owner_;  // of each unknown: the row it belongs to, or -1
    std::vector<Index> extra_, own_;
    std::optional<KluRefactorable> klu_;
    std::vector<Index> home_;  // of each entry of by_row_: its place in the pattern
    std::optional<Set> factored_;
    Vector x_;
};

}  // namespace tact
