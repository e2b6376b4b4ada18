#include "acceleration.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace tact {
namespace {

/// A gap or its rate counts as zero below this fraction of the largest.
constexpr double rounding = 1e-12;

}  // namespace

Derivative::Derivative(const Shared<ContactProblem>& problem, const ContactWorkspace& workspace)
    : owned_(problem),
      workspace_(workspace),
      stages_(problem, workspace),
      force_(problem->size()),
      work_(problem->size()),
      gap_(problem->constraints()),
      rate_(Vector::Zero(problem->constraints())),
      bound_(problem->constraints()),
      mu_(Vector::Zero(problem->constraints())),
      solution_(problem->size()),
      scratch_(problem->c.mode_count()) {
    require_contact_rows("Derivative", *problem);
}

void Derivative::operator()(double t, const ConstVectorRef& y, VectorRef out) {
    const ContactProblem& p = problem_;
    const Index n = p.size();
    force_ = stages_.load(t, Side::right);
    p.K.multiply(y.head(n), force_, -1, 1);
    if (p.r) {
        p.r->force(y.head(n), work_);
        force_ -= work_;
    }
    if (p.second_order() && p.D) p.D->multiply(y.tail(n), force_, -1, 1);
    if (p.constraints() > 0) {
        p.c.evaluate(t, Side::right, scratch_, bound_);
        p.B.multiply(y.head(n), gap_);
        const double size = std::max(gap_.lpNorm<Eigen::Infinity>(),
                                     (bound_.array() == -infinity).select(0, bound_).lpNorm<Eigen::Infinity>());
        double speed = 0;
        if (p.second_order()) {
            p.B.multiply(y.tail(n), rate_);
            speed = rate_.lpNorm<Eigen::Infinity>();
        }
        for (Index i = 0; i < bound_.size(); ++i) {
            const bool closed = gap_[i] - bound_[i] <= rounding * size && rate_[i] <= rounding * speed;
            bound_[i] = closed ? 0 : -infinity;
        }
        mu_.setZero();
    }
    const Combination combination = p.second_order() ? Combination{1, 0, 0} : Combination{0, 1, 0};
    solution_.setZero();
    const ContactReport report = workspace_.prepared(p, combination)->solve(force_, bound_, {solution_, mu_});
    if (report.outcome != Outcome::converged)
        throw NumericalError("Derivative: the contact solve with " + std::string(p.second_order() ? "M" : "D") +
                             " ended " + std::string(to_string(report.outcome)) + ", expected converged");
    if (p.second_order()) {
        out.head(n) = y.tail(n);
        out.tail(n) = solution_;
    } else {
        out = solution_;
    }
}

}  // namespace tact
