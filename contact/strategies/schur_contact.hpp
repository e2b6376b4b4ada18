// One factor of A for ever; contact on the dense block of B A^-1 B' that has been touched so far.
#pragma once

#include <limits>

#include "../../lib/contact_solver.hpp"

namespace tact {

class LinearSolver;

/// For constant symmetric A and few touched rows: static problems asked again and again, marches with sustained
/// contact. Rows enter a pool the first time they are violated; each costs a solve on the part of the factor that the pool's
/// rows reach, ever. A solve is: free solution, primal-dual active set on the pool (whose factor changes by the rows that
/// come and go), back-substitution, and a check of every row outside the pool; the pool only grows within a solve, so
/// it ends. Any B.
struct SchurOptions {
    /// Of the pool, 8 bytes for each pair of its rows (half as much again is taken to work with): beyond it the rows that are not in contact are forgotten. Rows
    /// in contact are kept whatever they take.
    std::size_t pool_bytes = std::size_t{256} << 20;
    /// NumericalError from prepare where a direction of A, scaled to unit diagonal, is softer than this: there A^-1 b cancels.
    double least_stiffness = 0;
    /// Rows that the pool may hold. A solve that needs more ends with `iteration_limit`, for another strategy to go on.
    Index pool_rows = std::numeric_limits<Index>::max();
};

class SchurContact final : public ContactSolver {
public:
    using Options = SchurOptions;
    /// `linear`: factors A; CHOLMOD by default.
    explicit SchurContact(Options options = {}, std::shared_ptr<const LinearSolver> linear = nullptr);
    std::unique_ptr<PreparedContact> prepare(const Matrix& A, const Matrix& B) const override;

private:
    Options options_;
    std::shared_ptr<const LinearSolver> linear_;
};

}  // namespace tact
