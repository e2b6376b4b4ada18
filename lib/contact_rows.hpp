// What the rows of B ask: an interval for B u and an interval for the multiplier.
#pragma once

#include "types.hpp"

namespace tact {

/// One row asks for
///   lower_i <= B_i u <= upper_i,   force_lower_i <= lambda_i <= force_upper_i,
/// and a multiplier acts only where the row is held:
///   lambda_i > 0   B_i u = lower_i, or B_i u < lower_i where lambda_i = force_upper_i (the row gives way),
///   lambda_i < 0   B_i u = upper_i, or B_i u > upper_i where lambda_i = force_lower_i,
///   lambda_i = 0   B_i u lies between.
/// Contact: upper = infinity. Bounds on both sides: lower < upper. An equation: lower = upper. A friction bound s: lower =
/// upper and [-s, s] for the multiplier. A row without bounds (-infinity, infinity) is off. These are the conditions of
///   min 1/2 u'Au - u'b + sum_i p_i(B_i u)
/// where p_i is convex, zero between the bounds and rises with slope force_upper_i below and -force_lower_i above them.
/// A view: the vectors, of m numbers each, must outlive it.
struct RowBounds {
    /// Contact rows.
    explicit RowBounds(const ConstVectorRef& c) : lower(c) {}
    RowBounds(const ConstVectorRef& lower_, const Vector* upper_, const Vector* force_lower_ = nullptr,
              const Vector* force_upper_ = nullptr)
        : lower(lower_), upper(upper_), force_lower(force_lower_), force_upper(force_upper_) {}

    ConstVectorRef lower;
    const Vector* upper = nullptr;        ///< none: infinity
    const Vector* force_lower = nullptr;  ///< none: -infinity; entries <= 0
    const Vector* force_upper = nullptr;  ///< none: infinity; entries >= 0

    Index size() const { return lower.size(); }
    /// Whether no row has more than a lower bound.
    bool contact_only() const { return !upper && !force_lower && !force_upper; }

    double upper_of(Index i) const { return upper ? (*upper)[i] : infinity; }
    /// The multipliers that the row allows: none where there is no bound to hold it at.
    double least_force(Index i) const {
        return upper_of(i) == infinity ? 0 : force_lower ? (*force_lower)[i] : -infinity;
    }
    double most_force(Index i) const {
        return lower[i] == -infinity ? 0 : force_upper ? (*force_upper)[i] : infinity;
    }
};

}  // namespace tact
