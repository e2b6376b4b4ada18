// Contact for reduced and other small problems: dense or diagonal A, one Schur complement, Goldfarb-Idnani.
#pragma once

#include "../../lib/contact_solver.hpp"

namespace tact {

struct DenseContactOptions {
    /// eps >= 0: contact gives way by E lambda with E = eps diag(B A^-1 B'). What a reduced basis cannot resolve is
    /// then not pressed into it: the error of reduced marches falls, at a penetration of (E lambda)_i in row i. For
    /// marches; in statics, and where energy is to be proven, leave it at 0.
    double compliance = 0;
    /// Where A is diagonal and B has 8 rows or more: only rows that are not proven open are solved and certified. The
    /// answer is the same to the last bit where nothing touches, to rounding where something does.
    bool screening = true;
};

/// Prepares W = A^-1 B' and S = B W once (beyond 1200 rows only the entries of S that contact asks for); a solve is u = A^-1 b, a gap check, and, where rows are violated, the
/// dual active set from the multipliers it is given. With compliance it solves  A u = b + B'lambda,
/// B u - c + E lambda >= 0, and the residuals are those of these conditions. A: symmetric positive definite, dense or
/// diagonal; B: any kind. InputError for a sparse A with more than 2000 unknowns or a compliance that is not >= 0;
/// NumericalError if A is not positive definite.
class DenseContact final : public ContactSolver {
public:
    explicit DenseContact(DenseContactOptions options = {}) : options_(options) {}
    std::unique_ptr<PreparedContact> prepare(const Matrix& A, const Matrix& B) const override;

private:
    DenseContactOptions options_;
};

}  // namespace tact
