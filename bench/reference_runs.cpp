#include "tact/bench/reference_runs.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "tact/bench/interrupt.hpp"
#include "tact/bench/timing.hpp"
#include "tact/contact/automatic.hpp"

namespace tact::bench {
namespace {

/// The largest finite |c|: what penetrations are measured by.
double gap_scale(const Vector& c) { return (c.array() > -infinity).select(c.array().abs(), 0).maxCoeff(); }

}  // namespace

double ReducedErrors::worst() const {
    return squared_percent.empty() ? std::nan("") : *std::ranges::max_element(squared_percent);
}

double ReducedErrors::median() const { return bench::median(squared_percent); }

MarchOptions march_options(const ReducedBasis& basis) {
    return {basis.signs == DualSigns::any ? InitialPenetration::accept : InitialPenetration::reject};
}

ReferenceRuns::ReferenceRuns(const StudyScene& scene, const Scheme& scheme, std::vector<Parameter> gammas)
    : scene_(scene), scheme_(scheme), gammas_(std::move(gammas)) {
    ContactWorkspace workspace(std::make_shared<AutomaticContact>());
    Progress progress(scene.name + ": full runs at test parameters", static_cast<double>(gammas_.size()));
    for (const Parameter& gamma : gammas_) {
        const ContactProblem problem = scene.family->at(gamma);
        if (!problem.c.constant()) throw InputError("ReferenceRuns: the gap varies in time, expected a constant one");
        Run& kept = runs_.emplace_back();
        kept.u.resize(problem.size(), scheme.integrator ? scheme.grid.steps + 1 : 1);
        const std::vector<Observer> record{[&](const State& state, const StepReport&) {
            kept.u.col(state.step) = state.u().cast<float>();
            kept.squared_norm += state.u().squaredNorm();
            return Flow::proceed;
        }};
        (void)run(scene.name + ", full", problem, scheme, workspace, record);
        progress.add(1);
    }
}

ReducedErrors ReferenceRuns::errors(const ReducedBasis& basis, const ContactFamily& reduced,
                                    ContactWorkspace& workspace) const {
    ReducedErrors result;
    const Single U = basis.U.cast<float>();
    const Single B_U = scene_.family->at(gammas_.front()).B.times(basis.U).cast<float>();
    const bool nodal = B_U.rows() == U.rows() && B_U == U;  // B U q is then U q
    constexpr Index block = 256;
    Single lifted, q;
    for (std::size_t k = 0; k < gammas_.size(); ++k) {
        throw_if_interrupted();
        const Run& full = runs_[k];
        const ContactProblem problem = reduced.at(gammas_[k]);
        const AffineVector c = scene_.family->at(gammas_[k]).c;
        q.resize(problem.size(), full.u.cols());
        Outcome outcome = Outcome::converged;
        double kkt = 0;
        if (scheme_.integrator) {
            const std::vector<Observer> record{[&](const State& state, const StepReport&) {
                q.col(state.step) = state.u().cast<float>();
                return Flow::proceed;
            }};
            const MarchReport march =
                integrate(*scheme_.integrator, problem, scheme_.grid, workspace, record, march_options(basis));
            outcome = march.outcome;
            kkt = march.worst_kkt.largest();
        } else {
            const StaticSolution solution = solve_static(problem, workspace);
            outcome = solution.report.outcome;
            kkt = solution.report.kkt.largest();
            q = solution.u.cast<float>();
        }
        if (outcome != Outcome::converged) {
            result.outcome = outcome;
            result.failed = gammas_[k];
            return result;
        }
        result.worst_kkt = std::max(result.worst_kkt, kkt);

        Vector gap = c.at(0);
        const double scale = gap_scale(gap);
        // Rows i to i + count of B U q against the gap.
        const auto penetrate = [&](const Single& image, Index i, Index count) {
            for (Index j = 0; j < image.cols(); ++j)
                result.penetration =
                    std::max(result.penetration,
                             (gap.segment(i, count) - image.col(j).head(count).cast<double>()).maxCoeff() / scale);
        };
        double error = 0;
        lifted.resize(block, q.cols());
        for (Index i = 0; i < U.rows(); i += block) {
            const Index count = std::min(block, U.rows() - i);
            lifted.topRows(count).noalias() = U.middleRows(i, count) * q;
            error += (lifted.topRows(count) - full.u.middleRows(i, count)).cast<double>().squaredNorm();
            if (nodal) penetrate(lifted, i, count);
        }
        for (Index i = 0; !nodal && i < B_U.rows(); i += block) {
            const Index count = std::min(block, B_U.rows() - i);
            lifted.topRows(count).noalias() = B_U.middleRows(i, count) * q;
            penetrate(lifted, i, count);
        }
        result.squared_percent.push_back(100 * error / full.squared_norm);
    }
    return result;
}

}  // namespace tact::bench
