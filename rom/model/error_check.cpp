#include "error_check.hpp"

#include <cmath>

namespace tact {
namespace {

double ratio(double squares, double size) { return squares > 0 ? std::sqrt(squares / size) : 0; }

}  // namespace

ErrorCheck::ErrorCheck(const Shared<ReducedModel>& model) : owned_(model) {
    const ErrorChecks& checks = model_.data().checks;
    gap_.resize(static_cast<Index>(checks.rows.size()));
    unknown_.resize(static_cast<Index>(checks.unknowns.size()));
}

void ErrorCheck::begin(const Parameter& gamma, const Shared<ContactProblem>& reduced) {
    gamma_ = gamma;
    reduced_ = reduced;
    penetration_ = residual_ = size_ = 0;
    if (gap_.size() > 0 && reduced->c.constant()) model_.checked_gap(gamma, 0, gap_);
    if (unknown_.size() > 0 && !reduced->is_static())
        inertia_ = DenseLinearSolver().factorize(reduced->M ? *reduced->M : *reduced->D);
    load_.resize(reduced->f.modes.cols());
}

void ErrorCheck::add(const State& state) {
    if (!reduced_->is_static() && (state.step == 0 || state.step % model_.data().checks.stride != 0)) return;
    size_ += state.u().squaredNorm();
    if (gap_.size() > 0) {
        if (!reduced_->c.constant()) model_.checked_gap(gamma_, state.t, gap_);
        row_.noalias() = model_.data().checks.B_U * state.u();
        penetration_ += (gap_ - row_).cwiseMax(0).squaredNorm();
    }
    if (unknown_.size() > 0) add_residual(state);
}

/// M U a + D U v + K U q - f - B'U_lambda s, with a from M_r a = f_r + B_r's - D_r v - K_r q.
void ErrorCheck::add_residual(const State& state) {
    const ErrorChecks& checks = model_.data().checks;
    const ContactProblem& p = *reduced_;
    if (p.f.constant())
        load_.setOnes();
    else
        p.f.coefficients(state.t, Side::left, load_);
    unknown_.noalias() = checks.K_U * state.u();
    unknown_.noalias() -= checks.load * load_;
    unknown_.noalias() -= checks.multipliers * state.lambda;
    if (!p.is_static()) {
        rate_.noalias() = p.f.modes * load_;
        p.B.multiply_transposed(state.lambda, rate_, 1, 1);
        p.K.multiply(state.u(), rate_, -1, 1);
        if (p.M && p.D) p.D->multiply(state.v(), rate_, -1, 1);
        inertia_->solve(rate_);
        if (p.M && p.D) unknown_.noalias() += checks.D_U * state.v();
        unknown_.noalias() += (p.M ? checks.M_U : checks.D_U) * rate_;
    }
    residual_ += unknown_.squaredNorm();
}

double ErrorCheck::penetration() const { return ratio(penetration_, size_); }
double ErrorCheck::residual() const { return ratio(residual_, size_); }

std::optional<double> ErrorCheck::estimate() const {
    const ErrorChecks& checks = model_.data().checks;
    if (checks.calibrated_on == 0) return std::nullopt;
    if (!model_.covers(gamma_)) return infinity;
    return checks.penetration_weight * penetration() + checks.residual_weight * residual();
}

}  // namespace tact
