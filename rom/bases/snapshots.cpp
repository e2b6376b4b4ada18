#include "snapshots.hpp"

#include <algorithm>
#include <string>

#include "../../lib/errors.hpp"

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

SnapshotRecorder::SnapshotRecorder(Index unknowns, long steps, SnapshotSelection selection, DualSnapshots& dual,
                                   Sink sink)
    : selection_(selection), dual_(dual), sink_(std::move(sink)) {
    if (selection.primal < 1 || selection.dual < 1)
        throw InputError("SnapshotSelection: primal is " + std::to_string(selection.primal) + " and dual is " +
                         std::to_string(selection.dual) + ", expected both at least 1");
    if (!(selection.tolerance >= 0 && selection.tolerance < 1))
        throw InputError("SnapshotSelection: tolerance is " + shown(selection.tolerance) +
                         ", expected 0 <= tolerance < 1");
    const Index expected = std::max<Index>(steps / selection.primal, 1), blocks = (expected + block - 1) / block;
    primal_.resize(unknowns, (expected + blocks) / blocks);  // with room for a state at the start
}

Observer SnapshotRecorder::observer() {
    count_ = 0;
    last_primal_.resize(0);
    last_dual_.resize(0);
    return [this](const State& state, const StepReport&) {
        if (state.step % selection_.dual == 0 && is_new(state.lambda, last_dual_)) dual_.add(state.lambda);
        if (state.step % selection_.primal != 0 || state.u().isZero(0) || !is_new(state.u(), last_primal_))
            return Flow::proceed;
        if (count_ == primal_.cols()) flush();
        primal_.col(count_++) = state.u();
        return Flow::proceed;
    };
}

void SnapshotRecorder::flush() {
    if (count_ > 0) sink_(primal_.leftCols(count_));
    count_ = 0;
}

/// Whether x is to be kept; `kept` is then x.
bool SnapshotRecorder::is_new(const ConstVectorRef& x, Vector& kept) const {
    if (selection_.tolerance == 0) return true;
    if (kept.size() == x.size() && (x - kept).norm() <= selection_.tolerance * x.norm()) return false;
    kept = x;
    return true;
}

}  // namespace tact
