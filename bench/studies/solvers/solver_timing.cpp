#include "solver_timing.hpp"

#include <algorithm>

#include "../../harness/interrupt.hpp"
#include "../../harness/isolated.hpp"
#include "../../harness/timed_contact.hpp"
#include "../../harness/timing.hpp"

namespace tact::bench {
namespace {

/// The samples in turn, as often as asked or as there is time for.
void time_samples(Json& row, const SolverProblem& problem, const ContactSolver& solver,
                  const TimingOptions& options) {
    std::vector<std::vector<double>> seconds;
    double iterations = 0, weight = 0, kkt = 0, error = 0;
    Outcome outcome = Outcome::converged;
    std::string strategy;
    const double start = cpu_seconds();
    for (int repeat = 0; repeat < options.repeats; ++repeat) {
        if (repeat > 0 && cpu_seconds() - start > options.enough) break;
        std::unique_ptr<PreparedContact> prepared;
        seconds.emplace_back();
        for (std::size_t k = 0; k < problem.samples.size(); ++k) {
            throw_if_interrupted();
            const SampledSolve& sample = problem.samples[k];
            Vector u = sample.u, lambda = sample.lambda;
            ContactReport report;
            const auto prepare = [&] { prepared = solver.prepare(sample.A, sample.B); };
            const double set_up = prepared ? 0 : seconds_of(prepare);
            const double solve = seconds_of([&] { report = prepared->solve(sample.b, sample.c, {u, lambda}); });
            seconds.back().push_back(solve + (problem.cold ? set_up : 0));
            if (repeat > 0) continue;
            if (report.outcome != Outcome::converged) outcome = report.outcome;
            kkt = std::max(kkt, report.kkt.largest());
            error = std::max(error, solution_error(u, sample));
            iterations += problem.weights[k] * report.iterations;
            weight += problem.weights[k];
            strategy = report.strategy;
            if (!report.fallback.empty()) strategy += ", " + std::string(report.fallback);
        }
    }
    row["outcome"] = to_string(outcome);
    row["strategy"] = strategy;
    put_seconds(row, problem, seconds);
    row["iterations"] = weight > 0 ? iterations / weight : 0.0;
    row["how"] = problem.march ? "from " + std::to_string(problem.samples.size()) + " sampled steps" : problem.what;
    if (outcome != Outcome::converged) return;  // the point is untouched: nothing to judge
    row["kkt_residual"] = kkt;
    row["solution_error"] = error;
}

void time_march(Json& row, const SolverProblem& problem, std::shared_ptr<const ContactSolver> solver,
                const TimingOptions& options) {
    const auto steps = static_cast<double>(problem.scheme.steps());
    const double expected = row["seconds_median"].get<double>() * steps;
    if (row["outcome"] != "converged" || expected > options.march_at) return;
    std::vector<double> means;
    const double start = cpu_seconds();
    for (int repeat = 0; repeat < options.repeats; ++repeat) {
        if (repeat > 0 && cpu_seconds() - start > options.enough) break;
        TimedContact::Totals totals;
        ContactWorkspace workspace(std::make_shared<TimedContact>(solver, totals));
        (void)run(problem.name, *problem.march, problem.scheme, workspace);
        means.push_back(totals.seconds / steps);
        row["iterations"] = totals.iterations / steps;
        row["kkt_residual"] = std::max(row["kkt_residual"].get<double>(), totals.worst_kkt);
    }
    row["seconds_median"] = median(means);
    row["seconds_min"] = *std::ranges::min_element(means);
    row["how"] = "the whole march, set-up not counted";
}

}  // namespace

Json empty_row(const SolverProblem& problem, const std::string& solver, bool peer) {
    Json row;
    row["problem"] = problem.name;
    row["solver"] = solver;
    for (const char* field : {"seconds_median", "seconds_min", "iterations", "kkt_residual", "solution_error"})
        row[field] = nullptr;
    row["peer"] = peer;
    return row;
}

void put_seconds(Json& row, const SolverProblem& problem, const std::vector<std::vector<double>>& seconds) {
    std::vector<double> sums;
    for (const std::vector<double>& repeat : seconds) {
        double sum = 0;
        for (std::size_t k = 0; k < repeat.size(); ++k) sum += problem.weights[k] * repeat[k];
        sums.push_back(sum);
    }
    row["seconds_median"] = median(sums);
    row["seconds_min"] = *std::ranges::min_element(sums);
}

double solution_error(const Vector& u, const SampledSolve& sample) {
    const double size = sample.solution.lpNorm<Eigen::Infinity>();
    return (u - sample.solution).lpNorm<Eigen::Infinity>() / (size > 0 ? size : 1.0);
}

Json time_solver(const SolverProblem& problem, const NamedSolver& solver, const TimingOptions& options) {
    const Json row = empty_row(problem, solver.name, solver.peer);
    Json result = isolated(
        [&] {
            Json filled = row;
            try {
                (void)solver.solver->prepare(problem.samples.front().A, problem.samples.front().B);
            } catch (const InputError& error) {
                filled["not_taken"] = error.what();
                return filled;
            }
            time_samples(filled, problem, *solver.solver, options);
            if (problem.march && !solver.peer) time_march(filled, problem, solver.solver, options);
            return filled;
        },
        options.limit);
    result.erase("peak_bytes");
    if (result.contains("not_taken")) return nullptr;
    if (!result.contains("error")) return result;
    Json failed = row;
    failed["message"] = result["error"];
    return failed;
}

}  // namespace tact::bench
