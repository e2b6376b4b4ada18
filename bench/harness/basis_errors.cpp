#include "basis_errors.hpp"

#include <array>

#include "../../contact/automatic.hpp"
#include "../../contact/dense/dense_contact.hpp"
#include "../../lib/time/trajectory.hpp"
#include "interrupt.hpp"

namespace tact::bench {
namespace {

/// The states of one run, a column each.
DenseMatrix states_of(const std::string& who, const ContactProblem& problem, const Scheme& scheme,
                      ContactWorkspace& workspace) {
    if (scheme.integrator) {
        Trajectory trajectory(problem, scheme.grid.steps, {.stride = 1, .initial = true, .multipliers = false});
        const std::array observers{trajectory.observer()};
        (void)run(who, problem, scheme, workspace, observers);
        return trajectory.u();
    }
    throw_if_interrupted();
    StaticSolution solution = solve_static(problem, workspace);
    if (solution.report.outcome != Outcome::converged)
        throw NumericalError(who + ": the contact solve ended with " +
                             std::string(to_string(solution.report.outcome)));
    return std::move(solution.u);
}

}  // namespace

TrainingContact study_contact() { return {std::make_shared<AutomaticContact>(), std::make_shared<DenseContact>()}; }

Vector squared_distances(const DenseMatrix& U, const DenseMatrix& q, const Eigen::Ref<const DenseMatrix>& u) {
    constexpr Index block_rows = 256;
    Vector result = Vector::Zero(u.cols());
    DenseMatrix difference(block_rows, u.cols());
    for (Index i = 0; i < U.rows(); i += block_rows) {
        const Index rows = std::min(block_rows, U.rows() - i);
        auto part = difference.topRows(rows);
        part.noalias() = U.middleRows(i, rows) * q;
        part -= u.middleRows(i, rows);
        result += part.colwise().squaredNorm().transpose();
    }
    return result;
}

FullStates full_states(const StudyScene& scene, const Scheme& scheme, const std::vector<Parameter>& gammas,
                       ContactWorkspace& workspace) {
    FullStates full{gammas, {}};
    if (gammas.size() == 1) {
        full.u = states_of(scene.name + ", full", scene.family->at(gammas[0]), scheme, workspace);
        return full;
    }
    for (std::size_t k = 0; k < gammas.size(); ++k) {
        const DenseMatrix states = states_of(scene.name + ", full", scene.family->at(gammas[k]), scheme, workspace);
        if (k == 0) full.u.resize(states.rows(), states.cols() * static_cast<Index>(gammas.size()));
        full.u.middleCols(static_cast<Index>(k) * states.cols(), states.cols()) = states;
    }
    return full;
}

std::vector<double> squared_percents(const TestedBasis& basis, const Scheme& scheme, const FullStates& full) {
    const Index width = full.width();
    ContactWorkspace workspace(study_contact().reduced);
    DenseMatrix q(basis.U.cols(), full.u.cols());
    for (std::size_t k = 0; k < full.gammas.size(); ++k)
        q.middleCols(static_cast<Index>(k) * width, width) =
            states_of("reduced", basis.reduced->at(full.gammas[k]), scheme, workspace);
    const Vector distances = squared_distances(basis.U, q, full.u);
    std::vector<double> percents;
    for (Index k = 0; k < static_cast<Index>(full.gammas.size()); ++k)
        percents.push_back(100 * distances.segment(k * width, width).sum() /
                           full.u.middleCols(k * width, width).squaredNorm());
    return percents;
}

}  // namespace tact::bench
