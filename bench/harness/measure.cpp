#include "measure.hpp"

#include <algorithm>
#include <array>
#include <limits>

#include "../../contact/automatic.hpp"
#include "../../integrators/quasi_static.hpp"
#include "../../integrators/sundials/bdf2.hpp"
#include "../../lib/time/trajectory.hpp"
#include "../../rom/error/relative_error.hpp"
#include "interrupt.hpp"
#include "timing.hpp"

namespace tact::bench {

Scheme paper_scheme(const StudyScene& scene) {
    if (scene.is_static()) return {};
    const TimeGrid grid = TimeGrid::until(scene.t_end, scene.dt);
    if (scene.family->at(scene.family->lower()).is_static()) return {std::make_shared<QuasiStatic>(), grid};
    return {std::make_shared<Bdf2>(), grid};
}

namespace {

[[noreturn]] void did_not_converge(const std::string& who, long step, Outcome outcome) {
    throw NumericalError(who + ": step " + std::to_string(step) + ": the contact solve ended with " +
                         std::string(to_string(outcome)));
}

StaticSolution solve(const std::string& who, const ContactProblem& problem, ContactWorkspace& workspace) {
    StaticSolution solution = solve_static(problem, workspace);
    if (solution.report.outcome != Outcome::converged) did_not_converge(who, 1, solution.report.outcome);
    return solution;
}

}  // namespace

RunSummary run(const std::string& who, const ContactProblem& problem, const Scheme& scheme,
               ContactWorkspace& workspace, std::span<const Observer> observers, const MarchOptions& options) {
    throw_if_interrupted();
    if (!scheme.integrator) {
        StaticSolution solution = solve(who, problem, workspace);
        const ContactReport& contact = solution.report;
        RunSummary summary{std::string(contact.strategy), contact.kkt.largest(), contact.active, 0};
        if (observers.empty()) return summary;
        State state(problem);
        state.y = std::move(solution.u);
        state.lambda = std::move(solution.lambda);
        StepReport step;
        step.contact = contact;
        for (const Observer& observer : observers) (void)observer(state, step);
        return summary;
    }
    std::vector<Observer> all(observers.begin(), observers.end());
    all.push_back(stop_on_interrupt());
    const MarchReport march = integrate(*scheme.integrator, problem, scheme.grid, workspace, all, options);
    throw_if_interrupted();
    if (march.outcome != Outcome::converged) did_not_converge(who, march.last.step, march.outcome);
    return {std::string(march.last.contact.strategy), march.worst_kkt.largest(), march.most_active,
            march.first_contact_step};
}

SampledMarch sample_march(const std::string& who, const ContactProblem& problem, const Scheme& scheme,
                          long in_contact, long free) {
    const auto solver = std::make_shared<AutomaticContact>();
    std::array<std::vector<long>, 2> solves;  // free, in contact; one solve a step
    const std::vector<Observer> look{[&](const State& state, const StepReport& report) {
        if (state.step > 0) solves[report.contact.active > 0 ? 1 : 0].push_back(state.step - 1);
        return Flow::proceed;
    }};
    ContactWorkspace first(solver);
    (void)run(who, problem, scheme, first, look);

    std::vector<std::pair<long, double>> chosen;
    const std::array<long, 2> wanted{free, in_contact};
    for (std::size_t kind = 0; kind < 2; ++kind) {
        const std::vector<long> places = spread(wanted[kind], static_cast<long>(solves[kind].size()));
        for (const long place : places)
            chosen.emplace_back(solves[kind][static_cast<std::size_t>(place)],
                                static_cast<double>(solves[kind].size()) / static_cast<double>(places.size()));
    }
    std::ranges::sort(chosen);
    SampledMarch march;
    std::vector<long> numbers;
    for (const auto& [number, steps] : chosen) {
        numbers.push_back(number);
        march.stands_for.push_back(steps);
    }
    ContactWorkspace second(std::make_shared<SampledContact>(solver, numbers, march.samples));
    (void)run(who, problem, scheme, second);
    const auto count = [](std::size_t n) { return std::to_string(n); };
    march.how = count(std::min<std::size_t>(static_cast<std::size_t>(in_contact), solves[1].size())) + " of the " +
                count(solves[1].size()) + " steps in contact and " +
                count(std::min<std::size_t>(static_cast<std::size_t>(free), solves[0].size())) + " of the " +
                count(solves[0].size()) +
                " others, spread evenly over the march, each from the recorded state before it, standing for all of "
                "their kind";
    return march;
}

Replay replay(const ContactSolver& solver, const std::vector<SampledSolve>& samples, int repeats,
              Progress& progress) {
    Replay result;
    std::unique_ptr<PreparedContact> prepared;
    const Matrix* prepared_A = nullptr;
    for (const SampledSolve& sample : samples) {
        Vector u, lambda;
        const auto solve_sample = [&] {
            u = sample.u;
            lambda = sample.lambda;
            return prepared->solve(sample.b, sample.c, {u, lambda}).outcome;
        };
        if (!prepared_A || !prepared_A->same_storage(sample.A)) {
            prepared = solver.prepare(sample.A, sample.B);
            prepared_A = &sample.A;
            (void)solve_sample();
        }
        std::vector<double> times;
        Outcome outcome = Outcome::converged;
        for (int k = 0; k < repeats; ++k) {
            throw_if_interrupted();
            times.push_back(seconds_of([&] { outcome = solve_sample(); }));
            progress.add(1.0 / repeats);
        }
        result.seconds.push_back(median(times));
        if (outcome != Outcome::converged) ++result.not_converged;
        const double size = std::max(sample.solution.norm(), std::numeric_limits<double>::min());
        result.worst_difference = std::max(result.worst_difference, (u - sample.solution).norm() / size);
    }
    return result;
}

WorstErrors worst_errors(const StudyScene& scene, const Scheme& scheme, const ReducedBasis& basis,
                         const ContactFamily& reduced, const std::vector<Parameter>& gammas,
                         ContactWorkspace& full_workspace, ContactWorkspace& reduced_workspace) {
    WorstErrors worst;
    std::vector<double> errors;
    Progress progress(scene.name + ": errors", static_cast<double>(gammas.size()));
    for (const Parameter& gamma : gammas) {
        const ContactProblem full = scene.family->at(gamma);
        const ContactProblem small = reduced.at(gamma);
        RelativeError error;
        if (!scheme.integrator) {
            const StaticSolution u = solve(scene.name + ", full", full, full_workspace);
            const StaticSolution q = solve(scene.name + ", reduced", small, reduced_workspace);
            error = relative_error(full, u, basis, q);
            worst.worst_kkt_full = std::max(worst.worst_kkt_full, u.report.kkt.largest());
            worst.worst_kkt_reduced = std::max(worst.worst_kkt_reduced, q.report.kkt.largest());
        } else {
            const Recording recording{.stride = 1, .initial = true, .multipliers = false};
            Trajectory u(full, scheme.grid.steps, recording), q(small, scheme.grid.steps, recording);
            const double before = static_cast<double>(errors.size());
            const auto tell = [&](const State& state, const StepReport&) {
                progress.at(before + static_cast<double>(state.step) / static_cast<double>(scheme.grid.steps));
                return Flow::proceed;
            };
            const std::vector<Observer> on_full{u.observer(), tell}, on_reduced{q.observer()};
            const RunSummary a = run(scene.name + ", full", full, scheme, full_workspace, on_full);
            const RunSummary b = run(scene.name + ", reduced", small, scheme, reduced_workspace, on_reduced);
            error = relative_error(full, u, basis, q);
            worst.worst_kkt_full = std::max(worst.worst_kkt_full, a.worst_kkt);
            worst.worst_kkt_reduced = std::max(worst.worst_kkt_reduced, b.worst_kkt);
        }
        const double gap_scale = full.c.modes.rowwise().sum().cwiseAbs().maxCoeff();
        worst.penetration_share = std::max(worst.penetration_share, error.penetration);
        worst.penetration = std::max(worst.penetration, error.penetration * gap_scale);
        if (errors.empty() || error.squared_percent > worst.squared_percent) worst.worst_gamma = gamma;
        worst.squared_percent = std::max(worst.squared_percent, error.squared_percent);
        worst.norm_percent = std::max(worst.norm_percent, error.norm_percent);
        errors.push_back(error.squared_percent);
        progress.at(static_cast<double>(errors.size()));
    }
    worst.median_squared_percent = median(errors);
    return worst;
}

}  // namespace tact::bench
