#include "tact/rom/training/snapshots.hpp"

#include <algorithm>
#include <string>

#include "tact/lib/errors.hpp"

namespace tact {

void DualSnapshots::add(const ConstVectorRef& lambda) {
    if (lambda.size() != constraints_)
        throw InputError("DualSnapshots: lambda is " + std::to_string(lambda.size()) + "x1, expected " +
                         std::to_string(constraints_) + "x1");
    const double smallest = constraints_ > 0 ? multiplier_rounding * lambda.maxCoeff() : 0;
    if (!(smallest > 0)) return;
    for (Index i = 0; i < constraints_; ++i) {
        if (!(lambda[i] > smallest)) continue;
        rows_.push_back(i);
        values_.push_back(lambda[i]);
    }
    starts_.push_back(static_cast<long>(rows_.size()));
}

SparseMatrix DualSnapshots::matrix() const {
    return Eigen::Map<const SparseMatrix>(constraints_, size(), static_cast<Index>(rows_.size()), starts_.data(),
                                          rows_.data(), values_.data());
}

SnapshotRecorder::SnapshotRecorder(Index unknowns, long steps, SnapshotStrides strides, DualSnapshots& dual)
    : strides_(strides), dual_(dual) {
    if (strides.primal < 1 || strides.dual < 1)
        throw InputError("SnapshotStrides: primal is " + std::to_string(strides.primal) + " and dual is " +
                         std::to_string(strides.dual) + ", expected both at least 1");
    primal_.resize(unknowns, steps / strides.primal + 1);
}

Observer SnapshotRecorder::observer() {
    count_ = 0;
    return [this](const State& state, const StepReport&) {
        if (state.step % strides_.dual == 0) dual_.add(state.lambda);
        if (state.step % strides_.primal == 0 && !state.u().isZero(0)) {
            if (count_ == primal_.cols())
                throw InputError("SnapshotRecorder: more states than the steps it was made for");
            primal_.col(count_++) = state.u();
        }
        return Flow::proceed;
    };
}

}  // namespace tact
