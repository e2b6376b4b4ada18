#include "calibration.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "../../lib/time/trajectory.hpp"
#include "../error/relative_error.hpp"
#include "../model/empirical_interpolation.hpp"
#include "../model/error_check.hpp"

namespace tact {
namespace {

struct Weights {
    double penetration = 0, residual = 0;
};

/// The indicators in units of each sample's error: the estimate is no less than it where w . column >= 1.
using Ratios = Eigen::Matrix<double, 2, Eigen::Dynamic>;

/// Minimises the mean of w . column subject to w . column >= 1 over directions of w; one sample may be left out.
Weights least_weights(const Ratios& ratios, Index left_out) {
    constexpr int directions = 200;
    // Both indicators in units of their own size, so that the directions mean the same whatever those are.
    const Eigen::Vector2d size = ratios.rowwise().mean().cwiseMax(1e-300);
    Weights best;
    double least = infinity;
    for (int k = 0; k <= directions; ++k) {
        const double angle = 0.5 * std::numbers::pi * k / directions;
        const Eigen::Vector2d w(k == directions ? 0 : std::cos(angle) / size[0],
                                k == 0 ? 0 : std::sin(angle) / size[1]);
        double smallest = infinity, sum = 0;
        for (Index j = 0; j < ratios.cols(); ++j) {
            if (j == left_out) continue;
            const double value = w.dot(ratios.col(j));
            smallest = std::min(smallest, value);
            sum += value;
        }
        if (!(smallest > 0) || sum / smallest >= least) continue;
        least = sum / smallest;
        best = {w[0] / smallest, w[1] / smallest};
    }
    return best;
}

/// A march, or a static solution, told to `record`; whether it converged.
bool run(const TrainingMethod& method, const ContactProblem& problem, const ContactWorkspace& workspace,
         const Observer& record) {
    if (method.integrator)
        return integrate(*method.integrator, problem, method.grid, workspace, {&record, 1},
                         {InitialPenetration::accept})
                   .outcome == Outcome::converged;
    StaticSolution solution = solve_static(problem, workspace);
    if (solution.report.outcome != Outcome::converged) return false;
    State state(problem);
    state.y = std::move(solution.u);
    state.lambda = std::move(solution.lambda);
    record(state, {});
    return true;
}

}  // namespace

void calibrate(ErrorChecks& checks, const std::vector<ErrorSample>& samples, double safety) {
    if (!(safety >= 1)) throw InputError("calibrate: safety is " + shown(safety) + ", expected at least 1");
    Ratios ratios(2, 0);
    for (std::size_t k = 0; k < samples.size(); ++k) {
        const ErrorSample& sample = samples[k];
        if (sample.error == 0) continue;
        if (!(sample.penetration > 0) && !(sample.residual > 0))
            throw InputError("calibrate: sample " + std::to_string(k) +
                             " has an error and no indicator, expected one; check more rows");
        ratios.conservativeResize(Eigen::NoChange, ratios.cols() + 1);
        ratios.rightCols(1) << sample.penetration / sample.error, sample.residual / sample.error;
    }
    if (ratios.cols() < 2)
        throw InputError("calibrate: there are " + std::to_string(ratios.cols()) +
                         " samples with an error, expected at least 2");
    const Weights weights = least_weights(ratios, -1);
    checks.penetration_weight = safety * weights.penetration;
    checks.residual_weight = safety * weights.residual;
    checks.calibrated_on = ratios.cols();
    std::vector<double> effectivity;
    for (Index j = 0; j < ratios.cols(); ++j) {
        const Weights others = least_weights(ratios, j);
        effectivity.push_back(safety * (others.penetration * ratios(0, j) + others.residual * ratios(1, j)));
    }
    std::sort(effectivity.begin(), effectivity.end());
    checks.least_effectivity = effectivity.front();
    checks.median_effectivity = effectivity[effectivity.size() / 2];
    checks.largest_effectivity = effectivity.back();
}

std::vector<Index> penetrated_rows(const Shared<ContactFamily>& family, const ReducedBasis& basis,
                                   const TrainingMethod& method, const TrainingContact& contact,
                                   const std::vector<Parameter>& parameters, Index count, long stride) {
    const auto reduced = reduce(family, basis);
    ContactWorkspace workspace(contact.reduced);
    const DenseMatrix B_U = family->at((family->lower() + family->upper()) / 2).B.times(basis.U);
    std::vector<Vector> found;
    for (const Parameter& gamma : parameters) {
        const AffineVector c = family->at(gamma).c;
        const std::size_t before = found.size();
        const bool converged = run(method, reduced->at(gamma), workspace, [&](const State& state, const StepReport&) {
            if (state.step % stride != 0 || (method.integrator && state.step == 0)) return Flow::proceed;
            Vector penetration = (c.at(state.t) - B_U * state.u()).cwiseMax(0);
            if (penetration.maxCoeff() > 0) found.push_back(std::move(penetration));
            return Flow::proceed;
        });
        if (!converged) found.resize(before);
    }
    if (found.empty()) return {};
    DenseMatrix penetrations(B_U.rows(), static_cast<Index>(found.size()));
    for (std::size_t k = 0; k < found.size(); ++k) penetrations.col(static_cast<Index>(k)) = found[k];
    return interpolate_empirically(penetrations, 0, count).points;
}

std::vector<ErrorSample> error_samples(const ContactFamily& family, const ReducedBasis& basis,
                                       const ReducedModel& model, const TrainingMethod& method,
                                       const TrainingContact& contact, const std::vector<Parameter>& parameters) {
    ContactWorkspace full_workspace(contact.full), workspace(contact.reduced);
    const long steps = method.integrator ? method.grid.steps : 0;
    ErrorCheck check(Shared<ReducedModel>::borrowed(model));
    std::vector<ErrorSample> samples;
    for (const Parameter& gamma : parameters) {
        const ContactProblem full = family.at(gamma);
        const Shared<ContactProblem> reduced = model.at(gamma);
        Trajectory u(full, steps, {1, true, false}), q(*reduced, steps, {1, true, false});
        const Observer record_full = u.observer(), record = q.observer();
        check.begin(gamma, reduced);
        const bool converged = run(method, full, full_workspace, record_full) &&
                               run(method, *reduced, workspace, [&](const State& state, const StepReport& report) {
                                   check.add(state);
                                   return record(state, report);
                               });
        if (!converged) continue;
        samples.push_back(
            {check.penetration(), check.residual(), relative_error(full, u, basis, q).norm_percent / 100});
    }
    return samples;
}

TrainingRecord training_record(const TrainingResult& result) {
    TrainingRecord record;
    for (const TrainingIteration& iteration : result.history) {
        record.samples.push_back(iteration.gamma);
        record.max_indicators.push_back(iteration.indicators.empty() ? std::numeric_limits<double>::quiet_NaN()
                                                                     : iteration.max_indicator);
    }
    record.stop_reason = to_string(result.reason);
    return record;
}

}  // namespace tact
