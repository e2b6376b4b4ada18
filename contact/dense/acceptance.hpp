// The last word on an answer: no large entry, row or unknown hides what is wrong elsewhere.
#pragma once

#include "../../lib/contact_solver.hpp"

namespace tact {

/// Judges (u, lambda) and infeasibility for one (A, B) in measures that do not change when rows or unknowns are scaled,
/// besides the residuals of lib/kkt.hpp. In units of energy an unknown is u_j sqrt(A_jj), a force b_j / sqrt(A_jj), and the
/// reach E is the largest of them; every gap may carry 4e-15 of sum_j |B_ij| / sqrt(A_jj) E, the rounding of u.
class Acceptance {
public:
    Acceptance(const Matrix& A, const Matrix& B);

    /// Fills in the report's residuals and active rows. The point takes (u, lambda) if
    ///   stationarity and negativity are within `tolerance`, stationarity in units of energy within 10 `tolerance`,
    ///   each row is violated by no more than `tolerance` of its own |c_i| + |B_i||u|,
    ///   complementarity is within `tolerance`, and lambda . gap within 1e-8 of the work sum lambda_i (|c_i| + |B_i||u|) +
    ///   |b_j u_j|;
    /// else the outcome is `inaccurate`. `reach`: of what the solver worked with besides, such as A^-1 b; in units of energy.
    void certify(ContactReport& report, const ConstVectorRef& b, const ConstVectorRef& c, const ConstVectorRef& u,
                 const ConstVectorRef& lambda, double tolerance, double reach, ContactPoint point) const;

    /// max_j |u_j| sqrt(A_jj).
    double reach(const ConstVectorRef& u) const { return u.cwiseProduct(stiffness_).lpNorm<Eigen::Infinity>(); }

    const KktCertificate& residuals() const { return certificate_; }

    /// Whether y >= 0 shows that no u satisfies the rows: B'y = 0 and c'y > 0, both beyond 1e-9 of their terms, and only a u ten
    /// thousand times as far as the rows' own places |c_i| / |B_i| could make up for what rounding leaves of B'y.
    bool excludes(const ConstVectorRef& y, const ConstVectorRef& c) const;

private:
    bool balances(const ConstVectorRef& b, const ConstVectorRef& u, const ConstVectorRef& lambda,
                  double tolerance) const;
    bool rows_are_met(const KktResiduals& kkt, const ConstVectorRef& b, const ConstVectorRef& c,
                      const ConstVectorRef& u, const ConstVectorRef& lambda, double tolerance, double reach) const;

    KktCertificate certificate_;
    Matrix A_;
    SparseMatrix Bt_;   // column i: row i of B
    Vector stiffness_;  // sqrt(A_jj), 1 where that is not positive
    Vector weight_;     // sum_j |B_ij| / sqrt(A_jj)
    bool uneven_;       // the diagonal of A spans more than two orders
};

}  // namespace tact
