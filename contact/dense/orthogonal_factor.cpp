#include "orthogonal_factor.hpp"

#include <algorithm>
#include <cmath>

namespace tact {

double OrthogonalFactor::split(const ConstVectorRef& d, VectorRef h, VectorRef z) const {
    if (k_ == 0) {
        z = d;
        return z.norm();
    }
    h.head(k_).noalias() = Q().transpose() * d;
    z = d;
    z.noalias() -= Q() * h.head(k_);
    // Half of d's length left: the projection is as orthogonal as it can be (Daniel, Gragg, Kaufman, Stewart, 1976).
    const double norm = z.norm();
    if (norm > 0.5 * d.norm()) return norm;
    // Once more: after cancellation the first projection leaves a part of Q behind.
    correction_.noalias() = Q().transpose() * z;
    z.noalias() -= Q() * correction_;
    h.head(k_) += correction_;
    return z.norm();
}

void OrthogonalFactor::append(const ConstVectorRef& h, const ConstVectorRef& z, double norm) {
    if (k_ == Q_.cols()) {
        const Index capacity = std::min(n_, std::max<Index>(16, 2 * k_));
        Q_.conservativeResize(n_, capacity);
        R_.conservativeResize(capacity, capacity);
    }
    Q_.col(k_) = z / norm;
    R_.col(k_).head(k_) = h.head(k_);
    R_(k_, k_) = norm;
    ++k_;
}

void OrthogonalFactor::remove(Index column) {
    for (Index j = column + 1; j < k_; ++j) R_.col(j - 1).head(j + 1) = R_.col(j).head(j + 1);
    --k_;
    // Each column from here on carries one entry below its diagonal.
    for (Index j = column; j < k_; ++j) {
        const double a = R_(j, j), b = R_(j + 1, j);
        const double r = std::hypot(a, b);
        const double c = r > 0 ? a / r : 1, s = r > 0 ? b / r : 0;
        R_(j, j) = r;
        R_(j + 1, j) = 0;
        for (Index i = j + 1; i < k_; ++i) {
            const double x = R_(j, i), y = R_(j + 1, i);
            R_(j, i) = c * x + s * y;
            R_(j + 1, i) = c * y - s * x;
        }
        double* q = Q_.col(j).data();
        double* p = Q_.col(j + 1).data();
        for (Index i = 0; i < n_; ++i) {
            const double x = q[i], y = p[i];
            q[i] = c * x + s * y;
            p[i] = c * y - s * x;
        }
    }
}

}  // namespace tact
