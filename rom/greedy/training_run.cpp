#include "training_run.hpp"

namespace tact {
namespace {

/// In one object from beginning to end: moving a report about makes GCC 12 warn of members that an empty optional lacks.
MarchReport static_run(const ContactProblem& problem, const ContactWorkspace& workspace,
                       std::span<const Observer> observers) {
    MarchReport report;
    StaticSolution solution = solve_static(problem, workspace);
    report.outcome = report.last.outcome = solution.report.outcome;
    report.last.contact = solution.report;
    report.worst_kkt = solution.report.kkt;
    report.most_active = solution.report.active;
    report.contact_iterations = solution.report.iterations;
    if (report.outcome == Outcome::converged) {
        report.final_state = State(problem);
        report.final_state.y = std::move(solution.u);
        report.final_state.lambda = std::move(solution.lambda);
        for (const Observer& observer : observers)
            if (observer(report.final_state, report.last) == Flow::stop) report.outcome = Outcome::stopped;
    }
    return report;
}

}  // namespace

MarchReport run_by(const TrainingMethod& method, const ContactProblem& problem, const ContactWorkspace& workspace,
                   std::span<const Observer> observers) {
    if (method.integrator) return integrate(*method.integrator, problem, method.grid, workspace, observers);
    return static_run(problem, workspace, observers);
}

}  // namespace tact
