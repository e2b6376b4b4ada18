#include "reference_runs.hpp"

#include <algorithm>
#include <cmath>
#include <future>
#include <utility>

#include "../../contact/automatic.hpp"
#include "interrupt.hpp"
#include "timing.hpp"

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
        const Vector c = problem.c.at(0);
        kept.gap = c.cast<float>();
        kept.gap_scale = gap_scale(c);
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
                                    std::shared_ptr<const ContactSolver> contact) const {
    Images images{basis.U.cast<float>(), scene_.family->at(gammas_.front()).B.times(basis.U).cast<float>()};
    images.nodal = images.B_U.rows() == images.U.rows() && images.B_U == images.U;
    // In two halves whatever the machine has, since a workspace remembers; nothing is timed here.
    const std::size_t half = (gammas_.size() + 1) / 2;
    const auto part = [&](std::size_t from, std::size_t to) {
        ContactWorkspace workspace(contact);
        ReducedErrors errors;
        for (std::size_t k = from; k < to && errors.outcome == Outcome::converged; ++k)
            add_error(k, basis, reduced, images, workspace, errors);
        return errors;
    };
    auto other = std::async(std::launch::async, part, half, gammas_.size());
    ReducedErrors result = part(0, half);
    const ReducedErrors second = other.get();
    if (result.outcome != Outcome::converged) return result;
    result.squared_percent.insert(result.squared_percent.end(), second.squared_percent.begin(),
                                  second.squared_percent.end());
    result.penetration = std::max(result.penetration, second.penetration);
    result.worst_kkt = std::max(result.worst_kkt, second.worst_kkt);
    result.outcome = second.outcome;
    result.failed = second.failed;
    return result;
}

void ReferenceRuns::add_error(std::size_t k, const ReducedBasis& basis, const ContactFamily& reduced,
                              const Images& images, ContactWorkspace& workspace, ReducedErrors& result) const {
    throw_if_interrupted();
    const auto& [U, B_U, nodal] = images;
    const Run& full = runs_[k];
    const ContactProblem problem = reduced.at(gammas_[k]);
    Single q(problem.size(), full.u.cols());
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
        return;
    }
    result.worst_kkt = std::max(result.worst_kkt, kkt);

    // Rows i to i + count of B U q against the gap.
    const auto penetrate = [&](const Single& image, Index i, Index count) {
        for (Index j = 0; j < image.cols(); ++j)
            result.penetration =
                std::max(result.penetration,
                         static_cast<double>((full.gap.segment(i, count) - image.col(j).head(count)).maxCoeff()) /
                             full.gap_scale);
    };
    constexpr Index block = 256;
    Single lifted(block, q.cols());
    double error = 0;
    for (Index i = 0; i < U.rows(); i += block) {
        const Index count = std::min(block, U.rows() - i);
        lifted.topRows(count).noalias() = U.middleRows(i, count) * q;
        error += (lifted.topRows(count) - full.u.middleRows(i, count)).colwise().squaredNorm().cast<double>().sum();
        if (nodal) penetrate(lifted, i, count);
    }
    for (Index i = 0; !nodal && i < B_U.rows(); i += block) {
        const Index count = std::min(block, B_U.rows() - i);
        lifted.topRows(count).noalias() = B_U.middleRows(i, count) * q;
        penetrate(lifted, i, count);
    }
    result.squared_percent.push_back(100 * error / full.squared_norm);
}

}  // namespace tact::bench
