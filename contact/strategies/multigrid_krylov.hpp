// Conjugate gradients in single precision with a multigrid cycle inside.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "../../lib/sparse/smoothed_aggregation.hpp"

namespace tact {

/// Preconditioned conjugate gradients on the unmasked unknowns of one level.
struct Krylov {
    using Floats = SmoothedAggregation::Floats;
    Floats residual, correction, z, p, q;
    float rz = 0;  // 0: no direction to go on from

    void resize(Index padded) {
        for (Floats* v : {&residual, &correction, &z, &p, &q}) v->setZero(padded);
    }

    /// correction ~ A^-1 residual, until the norm of the residual is down to `share`; returns where it is. The next call
    /// goes on with the last direction unless rz is zero: what it is given must be the same system's residual, `ratio`
    /// the unit it was measured in before over that of now.
    double solve(SmoothedAggregation& hierarchy, int level, const std::vector<int>& masked, double share,
                 double ratio) {
        correction.setZero();
        const float start = residual.squaredNorm();
        const float goal = static_cast<float>(share * share) * start;
        const auto rescale = static_cast<float>(ratio);
        if (rz > 0) {
            p *= rescale;
            rz *= rescale * rescale;
        }
        float left = start;
        for (int k = 0; k < step_limit && left > goal; ++k) {
            hierarchy.cycle(residual.data(), z.data());
            const float next = residual.dot(z);
            if (rz > 0)
                p = z + (next / rz) * p;
            else
                p = z;
            rz = next;
            const float pq = hierarchy.multiply(level, p.data(), q.data(), masked);
            const float alpha = next / pq;
            if (!(std::isfinite(alpha) && alpha > 0)) return infinity;
            left = 0;
            for (Index first = 0; first < p.size(); first += block) {
                const Index count = std::min(block, p.size() - first);
                correction.segment(first, count) += alpha * p.segment(first, count);
                residual.segment(first, count) -= alpha * q.segment(first, count);
                left += residual.segment(first, count).squaredNorm();
            }
        }
        return std::sqrt(static_cast<double>(left / start));
    }

private:
    static constexpr int step_limit = 40;
    static constexpr Index block = 2048;  // of a vector, to stay in the first cache
};

}  // namespace tact
