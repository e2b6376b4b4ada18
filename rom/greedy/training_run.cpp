#include "training_run.hpp"

namespace tact {

MarchReport run_by(const TrainingMethod& method, const ContactProblem& problem, const ContactWorkspace& workspace,
                   std::span<const Observer> observers) {
    if (method.integrator) return integrate(*method.integrator, problem, method.grid, workspace, observers);
    validate(problem);
    StaticSolution solution = solve_static(problem, workspace);
    MarchReport report;
    report.outcome = report.last.outcome = solution.report.outcome;
    report.last.contact = solution.report;
    report.worst_kkt = solution.report.kkt;
    report.most_active = solution.report.active;
    report.contact_iterations = solution.report.iterations;
    if (report.outcome != Outcome::converged) return report;
    report.final_state = State(problem);
    report.final_state.y = std::move(solution.u);
    report.final_state.lambda = std::move(solution.lambda);
    for (const Observer& observer : observers)
        if (observer(report.final_state, report.last) == Flow::stop) report.outcome = Outcome::stopped;
    return report;
}

}  // namespace tact
