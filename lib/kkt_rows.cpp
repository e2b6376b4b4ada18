// The certificate of rows with two intervals.
#include <algorithm>
#include <cmath>
#include <vector>

#include "kkt.hpp"

namespace tact {
namespace {

/// A bound beyond this is a way to write none.
constexpr double pseudo_infinite = 1e19;

/// 0/0 = 0, and what has decayed into underflow counts as zero.
double ratio(double numerator, double denominator) {
    return numerator == 0 ? 0 : numerator / std::max(denominator, underflow);
}

/// What one row adds, given B_i u and |B_i||u|.
struct RowResidual {
    double violation, outside;  // of the bounds, of the multiplier's interval
    double opening;             // from the bound that the multiplier holds it at
    double scale;               // |B_i||u| + |c_i|, zero for a row that is off
};

RowResidual row_residual(const RowBounds& rows, Index i, double moved, double size, double lambda) {
    const double lower = rows.lower[i], upper = rows.upper_of(i);
    const double least = rows.least_force(i), most = rows.most_force(i);
    RowResidual row{0, std::max({least - lambda, lambda - most, 0.0}), 0, 0};
    if (lambda < most) row.violation = std::max(row.violation, lower - moved);
    if (lambda > least) row.violation = std::max(row.violation, moved - upper);
    if (lambda > 0) row.opening = std::max(moved - lower, 0.0);
    if (lambda < 0) row.opening = std::max(upper - moved, 0.0);
    if (lower > -pseudo_infinite) row.scale = size + std::abs(lower);
    if (upper < pseudo_infinite) row.scale = std::max(row.scale, size + std::abs(upper));
    if (std::isnan(moved) || std::isnan(lambda) || std::isnan(lower) || std::isnan(upper)) row.violation = infinity;
    return row;
}

}  // namespace

KktResiduals KktCertificate::operator()(const ConstVectorRef& b, const RowBounds& rows, const ConstVectorRef& u,
                                        const ConstVectorRef& lambda) const {
    if (rows.contact_only()) return evaluate(b, rows.lower, u, lambda, nullptr);
    return evaluate_rows(b, rows, u, lambda, nullptr);
}

KktResiduals KktCertificate::operator()(const ConstVectorRef& b, const RowBounds& rows, const ConstVectorRef& u,
                                        const ConstVectorRef& lambda, const ConstVectorRef& r) const {
    if (rows.contact_only()) return evaluate(b, rows.lower, u, lambda, r.data());
    return evaluate_rows(b, rows, u, lambda, r.data());
}

KktResiduals KktCertificate::evaluate_rows(const ConstVectorRef& b, const RowBounds& rows, const ConstVectorRef& u,
                                           const ConstVectorRef& lambda, const double* r) const {
    // Of the rows as contact rows that are off only the balance of forces is taken.
    const KktResiduals balance = evaluate(b, Vector::Constant(rows.size(), -infinity), u, lambda, r);
    KktResiduals kkt;
    kkt.stationarity = balance.stationarity;
    auto& absolute = kkt.absolute;
    absolute.stationarity = balance.absolute.stationarity;
    Vector moved, size;
    row_products(u, moved, size);
    std::vector<RowResidual> residuals;
    residuals.reserve(static_cast<std::size_t>(rows.size()));
    double gaps = 0, multipliers = 0;
    for (Index i = 0; i < rows.size(); ++i) {
        residuals.push_back(row_residual(rows, i, moved[i], size[i], lambda[i]));
        gaps = std::max(gaps, residuals.back().scale);
        multipliers = std::max(multipliers, std::abs(lambda[i]));
    }
    for (std::size_t i = 0; i < residuals.size(); ++i) {
        const RowResidual& row = residuals[i];
        absolute.penetration = std::max(absolute.penetration, row.violation);
        absolute.negativity = std::max(absolute.negativity, row.outside);
        const double force = std::abs(lambda[static_cast<Index>(i)]);
        if (force == 0 || row.opening == 0) continue;
        const double share = force / multipliers;
        kkt.complementarity = std::max(kkt.complementarity, std::min(ratio(row.opening, gaps), share));
        absolute.complementarity = std::max(absolute.complementarity, row.opening * share);
    }
    kkt.penetration = std::isfinite(gaps) ? ratio(absolute.penetration, gaps) : infinity;
    kkt.negativity = ratio(absolute.negativity, multipliers);
    return kkt;
}

}  // namespace tact
