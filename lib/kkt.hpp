// The one definition of the KKT residual: what every accepted step carries.
#pragma once

#include <algorithm>
#include <limits>
#include <memory>
#include <span>

#include "contact_rows.hpp"
#include "problem/matrix.hpp"

namespace tact {

/// Numbers below this carry fewer digits than others, or their roundings do: a motion that decays for ever gets there. What
/// is measured against them is measured against this.
inline constexpr double underflow = std::numeric_limits<double>::min() / std::numeric_limits<double>::epsilon();

/// Scaled KKT residuals of  min 1/2 u'Au - u'b,  Bu >= c  at (u, lambda). Max norms, absolute values entrywise,
/// 0/0 = 0 (denominators are at least `underflow`: what has decayed that far is zero), rows with c = -infinity skipped:
///   stationarity     |Au - b - B'lambda| / (|A||u| + |b| + |B'||lambda|)
///   penetration      max(c - Bu, 0) / max(|B||u| + |c|), rows with c <= -1e19 ("none") left out of the scale
///   negativity       max(-lambda, 0) / max|lambda|
///   complementarity  max_i min(gap_i / max(|B||u| + |c|), lambda_i / max|lambda|)
struct KktResiduals {
    double stationarity = 0;
    double penetration = 0;
    double negativity = 0;
    double complementarity = 0;
    /// The largest of the four; NaN counts as infinity.
    double largest() const;

    /// The same without their scales: a force, a gap, a multiplier, and the largest gap_i lambda_i / max|lambda|.
    struct Absolute {
        double stationarity = 0;
        double penetration = 0;
        double negativity = 0;
        double complementarity = 0;
    } absolute;

    /// Each residual becomes the larger of the two; NaN counts as infinity.
    void raise_to(const KktResiduals& other);

    /// Whether a solve that worked with gaps of this size has reached the tolerance. Where all gaps and displacements of
    /// the solution vanish the scaled penetration is rounding over rounding: there 1e-13 of the gaps worked with decides.
    bool within(double tolerance, double gap_size) const;
};

/// Evaluates KktResiduals for one (A, B) and many (b, c, u, lambda), from the data alone: it shares no code with any
/// solver. Owns its own row-wise copy of A when A is sparse, and its work space.
class KktCertificate {
public:
    KktCertificate(const Matrix& A, const Matrix& B);
    ~KktCertificate();
    KktCertificate(KktCertificate&&) noexcept;
    KktCertificate& operator=(KktCertificate&&) noexcept;

    KktResiduals operator()(const ConstVectorRef& b, const ConstVectorRef& c, const ConstVectorRef& u,
                            const ConstVectorRef& lambda) const;

    /// The same for rows of every kind. penetration: beyond either bound, where the row does not give way; negativity:
    /// lambda outside the interval that its row allows; complementarity: lambda_i > 0 against B_i u - lower_i, lambda_i < 0
    /// against upper_i - B_i u. For contact rows the one above.
    KktResiduals operator()(const ConstVectorRef& b, const RowBounds& rows, const ConstVectorRef& u,
                            const ConstVectorRef& lambda) const;
    /// The same of  A u + r = b + B'lambda  for a force r that has been evaluated at u:
    ///   stationarity     |Au + r - b - B'lambda| / (|A||u| + |r| + |b| + |B'||lambda|)
    KktResiduals operator()(const ConstVectorRef& b, const RowBounds& rows, const ConstVectorRef& u,
                            const ConstVectorRef& lambda, const ConstVectorRef& r) const;

    /// The same where only the listed rows are in question: the caller has proven the others open, and they carry no
    /// multiplier. Their entries of c and lambda are not read, and the gaps' scale is that of the listed rows, which makes
    /// residuals larger at most. For a dense B; InputError for another.
    KktResiduals operator()(const ConstVectorRef& b, const ConstVectorRef& c, const ConstVectorRef& u,
                            const ConstVectorRef& lambda, std::span<const Index> rows) const;

private:
    struct Work;
    KktResiduals evaluate_rows(const ConstVectorRef& b, const RowBounds& rows, const ConstVectorRef& u,
                               const ConstVectorRef& lambda, const double* r) const;
    /// B u and |B||u|.
    void row_products(const ConstVectorRef& u, Vector& moved, Vector& size) const;
    KktResiduals evaluate(const ConstVectorRef& b, const ConstVectorRef& c, const ConstVectorRef& u,
                          const ConstVectorRef& lambda, const double* r) const;
    std::unique_ptr<Work> work_;
};

KktResiduals kkt_residuals(const Matrix& A, const Matrix& B, const Vector& b, const Vector& c, const Vector& u,
                           const Vector& lambda);

}  // namespace tact
