// The contact problem on those rows that were ever touched, behind one factor of A.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "../../lib/algebra/row_runs.hpp"
#include "../../lib/contact_solver.hpp"
#include "../dense/active_set.hpp"
#include "../dense/unsymmetric_active_set.hpp"
#include "../prepare/rows.hpp"

namespace tact {

class Factor;

/// X := A^-T X, for an A that is not symmetric; empty for one that is, whose S is too.
using TransposedSolve = std::function<void(Eigen::Ref<DenseMatrix>)>;

/// The touched rows and S = B A^-1 B' among them.
class Pool {
public:
    /// The factor and the rows must outlive this object.
    Pool(const Factor& factor, TransposedSolve transposed, const ConstraintRows& rows, std::size_t bytes);
    Index size() const { return static_cast<Index>(members_.size()); }
    /// Rows that the bytes allowed hold.
    Index largest() const { return largest_; }
    const std::vector<Index>& members() const { return members_; }
    bool holds(Index row) const { return place_[static_cast<std::size_t>(row)] >= 0; }
    const DenseMatrix& S() const { return S_; }

    void add(const std::vector<Index>& fresh);
    /// Forgets all rows but those given; their mutual compliance is kept.
    void keep(const std::vector<Index>& rows);

private:
    SparseMatrix columns() const;
    void add_unsymmetric(Index old);
    void reserve();

    const Factor& factor_;
    TransposedSolve transposed_;
    const ConstraintRows& rows_;
    Index largest_;
    std::vector<Index> members_, place_;
    DenseMatrix S_;
};

/// Contact by a pool that takes in the rows that a solution violates until it violates none, and a dense active set on it.
/// Solves with the factor: one for each row that is new, and one more for the answer.
class TouchedRows {
public:
    /// The factor and the rows must outlive this object.
    TouchedRows(const Factor& factor, TransposedSolve transposed, const Matrix& B, const ConstraintRows& rows,
                std::size_t pool_bytes);

    /// free: A^-1 b. guess: multipliers, of which the signs count. Other outcomes than converged are the dense active set's, and
    /// `iteration_limit` if more than `most_fresh` rows would have to join the pool.
    [[nodiscard]] Outcome solve(const Vector& free, const ConstVectorRef& c, const ConstVectorRef& guess,
                                ContactReport& report, Index most_fresh);

    /// After a solve: the answer, which is `free` itself where nothing touches.
    const Vector& u() const { return touching_ ? u_ : *free_; }
    const Vector& lambda() const { return lambda_; }
    const Pool& pool() const { return pool_; }

private:
    template <class Allowed>
    bool find_gaps(const Vector& u, const ConstVectorRef& c, Vector& gap, Allowed allowed) const;
    bool any_violated_in_pool(const ConstVectorRef& c) const;
    bool find_violated(const ConstVectorRef& c, const Vector& gap, std::size_t most);
    Outcome solve_pool(const ConstVectorRef& c, const ConstVectorRef& guess, ContactReport& report);
    void start_working_set(Index k);
    void take_all_if_most(Index k);
    void reserve(Index k);
    void take(Index i);
    bool take_violated(Index k, std::size_t most);
    CondensedActiveSet::Report solve_dense(const DenseMatrix& S, const ConstVectorRef& g,
                                           const ConstVectorRef& allowance, VectorRef lambda, VectorRef w);
    void forget_dense();
    CondensedActiveSet::Report solve_working_set(Index k);
    bool widen_working_set(Index k, std::size_t most);
    void forget(const ConstVectorRef& guess);

    static constexpr Index small_pool = 100;
    static constexpr std::size_t few = 8;  ///< rows that are taken at once when nothing is known yet
    /// Of the row's own |c_i| + |B_i||u|: two digits above the rounding of a solve.
    static constexpr double gap_tolerance = 2e-14;

    const Factor& factor_;
    const ConstraintRows& rows_;
    RowRuns runs_;
    Pool pool_;
    bool symmetric_;
    CondensedActiveSet active_set_;
    UnsymmetricActiveSet unsymmetric_;
    std::vector<Index> violated_, working_, candidates_;
    Index violated_count_ = 0;  // outside the pool, before the worst of them were taken
    std::vector<char> in_working_set_;
    bool factored_pool_ = false;  // what active_set_ has a factor of is a part of the pool
    bool touching_ = false;
    const Vector* free_ = nullptr;
    DenseMatrix S_;  // of the working set, as what follows
    Vector working_g_, working_allowance_, working_multiplier_, working_w_;
    Vector u_, gap_, free_gap_, allowance_, lambda_, pool_allowance_, g_, w_, multiplier_, force_;
};

}  // namespace tact
