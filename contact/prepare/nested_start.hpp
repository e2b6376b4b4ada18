// A start for active sets on bounds: the problem on coarser and coarser graphs, each solved from the one below.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "../../lib/types.hpp"

namespace tact {

/// Guesses which unknowns rest on a bound in
///   lower <= u <= upper,  A u - b >= 0 where u = lower, <= 0 where u = upper, = 0 between,
/// so that an active set begins a layer or two from the answer on any grid, instead of moving its front over the whole
/// way. Half of the unknowns or so are kept on each coarser graph: a greedy independent set of the strong couplings;
/// the others are eliminated through the couplings to those kept, rows and columns alike. On a tridiagonal A this is
/// cyclic reduction. Bounds are those of the kept unknowns. Each graph's set is found by the primal-dual active set
/// with a factor, from the coarser one's solution smoothed by projected Gauss-Seidel. Meant for A with positive
/// diagonal, symmetric or not, best near M-matrices; of another A the guess is worse, and never more than a guess.
///
/// A. Brandt, C. W. Cryer, SIAM J. Sci. Stat. Comput. 4 (1983) for nested obstacle problems; J. W. Ruge, K. Stueben,
/// Algebraic multigrid (1987), direct interpolation.
class NestedStart {
public:
    /// Keeps a copy of A; the coarser graphs are made when they are first asked for.
    explicit NestedStart(const SparseMatrix& A);
    ~NestedStart();

    /// side: -1 on lower, 1 on upper, 0 free. Bounds may be infinite; lower <= upper. u, which belongs to it, is within
    /// the bounds. false where no coarser graph could be made or solved: nothing is then said.
    [[nodiscard]] bool find(const ConstVectorRef& b, const ConstVectorRef& lower, const ConstVectorRef& upper,
                            Vector& u, std::vector<signed char>& side);

private:
    struct Level;
    bool coarsen(const SparseMatrix& A);

    SparseMatrix A_;
    std::vector<std::unique_ptr<Level>> levels_;
    bool made_ = false;
};

}  // namespace tact
