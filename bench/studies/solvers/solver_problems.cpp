#include "solver_problems.hpp"

#include <algorithm>
#include <map>
#include <numeric>
#include <random>

#include "../../../contact/automatic.hpp"
#include "../../../contact/strategies/klu_active_set.hpp"
#include "../../../contact/strategies/schur_contact.hpp"
#include "../../../rom/greedy/sampling.hpp"
#include "../../harness/interrupt.hpp"

namespace tact::bench {
namespace {

constexpr long sampled_in_contact = 6, sampled_free = 4;

/// |x - y| over the largest entry of y.
double difference(const Vector& x, const Vector& y) {
    const double size = y.lpNorm<Eigen::Infinity>();
    return (x - y).lpNorm<Eigen::Infinity>() / (size > 0 ? size : 1.0);
}

/// Replaces the recorded solutions by the tighter of two that have nothing in common but the problem.
void refer(SolverProblem& problem) {
    const std::vector<std::shared_ptr<const ContactSolver>> solvers{std::make_shared<SchurContact>(),
                                                                    std::make_shared<KluActiveSet>()};
    std::vector<std::unique_ptr<PreparedContact>> prepared;
    const SampledSolve& first = problem.samples.front();
    for (const auto& solver : solvers) prepared.push_back(solver->prepare(first.A, first.B));
    Progress progress(problem.name + ": reference", static_cast<double>(problem.samples.size()));
    for (SampledSolve& sample : problem.samples) {
        double best = infinity;
        std::vector<Vector> found;
        for (const auto& solver : prepared) {
            Vector u = sample.u, lambda = sample.lambda;
            const ContactReport report = solver->solve(sample.b, sample.c, {u, lambda});
            throw_if_interrupted();
            if (report.outcome != Outcome::converged) continue;
            found.push_back(u);
            if (report.kkt.largest() >= best) continue;
            best = report.kkt.largest();
            sample.solution = std::move(u);
        }
        if (found.empty()) throw NumericalError(problem.name + ": no strategy finds a reference solution");
        problem.reference_kkt = std::max(problem.reference_kkt, best);
        // Alone, a reference is only as good as its residual.
        const double apart = found.size() == 2 ? difference(found[0], found[1]) : infinity;
        problem.reference_agreement = std::max(problem.reference_agreement, apart);
        progress.add(1);
    }
}

std::vector<SolverProblem> static_problems(const StudyScene& scene) {
    constexpr Index further = 10;
    const ContactFamily& family = *scene.family;
    std::vector<Parameter> gammas = latin_hypercube(family.lower(), family.upper(), further, 1);
    gammas.insert(gammas.begin(), 0.5 * (family.lower() + family.upper()));

    SolverProblem cold{.name = "static, cold", .what = "one solve, set-up included", .cold = true};
    SolverProblem next{.name = "static, next gamma",
                       .what = "mean of " + std::to_string(further) +
                               " further parameters after a first one, from the solution before, set-up kept"};
    std::vector<long> all(gammas.size());
    std::iota(all.begin(), all.end(), 0);
    ContactWorkspace workspace(
        std::make_shared<SampledContact>(std::make_shared<AutomaticContact>(), all, next.samples));
    StaticSolution before;
    for (const Parameter& gamma : gammas) {
        const StaticSolution* guess = before.u.size() > 0 ? &before : nullptr;
        StaticSolution solution = solve_static(family.at(gamma), workspace, guess);
        throw_if_interrupted();
        before = std::move(solution);
    }
    next.weights.assign(gammas.size(), 1.0 / static_cast<double>(further));
    next.weights.front() = 0;
    refer(next);
    cold.samples = {next.samples.front()};
    cold.weights = {1};
    cold.reference_agreement = next.reference_agreement;
    cold.reference_kkt = next.reference_kkt;
    return {std::move(cold), std::move(next)};
}

std::vector<SolverProblem> march_problems(const StudyScene& scene) {
    const ContactFamily& family = *scene.family;
    const ContactProblem problem = family.at(0.5 * (family.lower() + family.upper()));
    const Scheme scheme = paper_scheme(scene);
    const auto solver = std::make_shared<AutomaticContact>();

    // Two runs: the first says where contact is, the second records; all of a march would not fit in memory.
    std::vector<Index> active;
    const std::vector<Observer> look{[&](const State& state, const StepReport& report) {
        if (state.step > 0) active.push_back(report.contact.active);
        return Flow::proceed;
    }};
    ContactWorkspace first(solver);
    (void)run(scene.name, problem, scheme, first, look);
    const long largest = std::max<long>(1, std::ranges::max_element(active) - active.begin());
    std::array<std::vector<long>, 2> kinds;
    for (std::size_t k = 0; k < active.size(); ++k) kinds[active[k] > 0 ? 1 : 0].push_back(static_cast<long>(k));
    std::map<long, double> stands_for{{largest - 1, 0}, {largest, 0}};
    const std::array<long, 2> wanted{sampled_free, sampled_in_contact};
    for (std::size_t kind = 0; kind < 2; ++kind) {
        const auto total = static_cast<long>(kinds[kind].size());
        const std::vector<long> places = spread(wanted[kind], total);
        for (const long place : places)
            stands_for[kinds[kind][static_cast<std::size_t>(place)]] +=
                static_cast<double>(total) / static_cast<double>(places.size());
    }
    std::vector<long> numbers;
    for (const auto& [number, weight] : stands_for) numbers.push_back(number);
    std::vector<SampledSolve> samples;
    ContactWorkspace second(std::make_shared<SampledContact>(solver, numbers, samples));
    (void)run(scene.name, problem, scheme, second);

    SolverProblem mean{.name = scene.name + ", mean of the march",
                       .what = "mean over " + std::to_string(scheme.steps()) + " steps",
                       .samples = std::move(samples)};
    for (const auto& [number, weight] : stands_for)
        mean.weights.push_back(weight / static_cast<double>(scheme.steps()));
    refer(mean);
    mean.march = problem;
    mean.scheme = scheme;
    SolverProblem most{.name = scene.name + ", largest contact",
                       .what = "step " + std::to_string(largest + 1) + " with " +
                               std::to_string(active[static_cast<std::size_t>(largest)]) +
                               " rows in contact, after the step before it",
                       .weights = {0, 1},
                       .reference_agreement = mean.reference_agreement,
                       .reference_kkt = mean.reference_kkt};
    const auto at = std::ranges::find(numbers, largest) - numbers.begin();
    most.samples.assign(mean.samples.begin() + at - 1, mean.samples.begin() + at + 1);
    return {std::move(most), std::move(mean)};
}

using Permutation = Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, long>;

Permutation shuffled(Index n, unsigned seed) {
    Permutation p(n);
    p.setIdentity();
    std::mt19937 random(seed);
    std::shuffle(p.indices().data(), p.indices().data() + n, random);
    return p;
}

/// Applies one numbering; a matrix that is shared stays shared.
class Numbering {
public:
    Numbering(Index n, Index m) : unknowns_(shuffled(n, 1)), rows_(shuffled(m, 2)) {}
    Matrix square(const Matrix& A) { return of(A, unknowns_); }
    Matrix constraints(const Matrix& B) { return of(B, rows_); }
    DenseMatrix unknowns(const DenseMatrix& x) const { return unknowns_ * x; }
    DenseMatrix rows(const DenseMatrix& x) const { return rows_ * x; }

private:
    Matrix of(const Matrix& A, const Permutation& left) {
        const auto [place, is_new] = known_.try_emplace(A.identity_key());
        if (!is_new) return place->second;
        if (const Vector* d = A.diagonal_entries(); d && &left == &unknowns_)
            place->second = Matrix::diagonal(left * *d);
        else
            place->second = Matrix(SparseMatrix(left * A.to_sparse() * unknowns_.transpose()));
        return place->second;
    }
    Permutation unknowns_, rows_;
    std::map<const void*, Matrix> known_;
};

}  // namespace

std::vector<SolverProblem> solver_problems(const std::string& name, Index n, double t_end) {
    StudyScene scene = study_scene(name, n);
    if (scene.is_static()) return static_problems(scene);
    if (t_end > 0) scene.t_end = t_end;
    return march_problems(scene);
}

SolverProblem permuted(const SolverProblem& problem) {
    const SampledSolve& first = problem.samples.front();
    Numbering to(first.A.rows(), first.B.rows());
    SolverProblem result = problem;
    for (SampledSolve& s : result.samples)
        s = {to.square(s.A),   to.constraints(s.B), to.unknowns(s.b),       to.rows(s.c),
             to.unknowns(s.u), to.rows(s.lambda),   to.unknowns(s.solution)};
    if (!result.march) return result;
    ContactProblem& march = *result.march;
    if (march.M) march.M = to.square(*march.M);
    if (march.D) march.D = to.square(*march.D);
    // K + a^2 M is one matrix and K another: both are renumbered alike.
    march.K = to.square(march.K);
    march.B = to.constraints(march.B);
    march.c.modes = to.rows(march.c.modes);
    march.f.modes = to.unknowns(march.f.modes);
    march.u0 = to.unknowns(march.u0);
    if (march.v0.size() > 0) march.v0 = to.unknowns(march.v0);
    return result;
}

}  // namespace tact::bench
