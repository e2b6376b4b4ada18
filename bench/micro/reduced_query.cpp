// What one query of the static model costs at the paper's size: p = 20, its gap at gamma included.
#include <benchmark/benchmark.h>

#include "../../contact/automatic.hpp"
#include "../../contact/dense/dense_contact.hpp"
#include "../../lib/scenes/membrane.hpp"
#include "../../lib/sparse/cholmod_solver.hpp"
#include "../../rom/error/static_error_bound.hpp"
#include "../../rom/greedy/calibration.hpp"
#include "../../rom/greedy/sampling.hpp"
#include "../../rom/model/online.hpp"

namespace tact::bench {
namespace {

struct Static {
    MembraneFamily family{200};
    TrainingContact contact{std::make_shared<AutomaticContact>(), std::make_shared<DenseContact>()};
    TrainingResult result;
    ReducedModelData data;
    std::vector<Parameter> gammas;

    Static() {
        TrainingOptions options;
        options.max_iterations = 20;
        options.candidates = tensor_grid(family.lower(), family.upper(), {10, 10});
        result = train(family, {}, contact, options);
        gammas = latin_hypercube(family.lower(), family.upper(), 64, 7);
        ReducedModelOptions model;
        model.check_rows = penetrated_rows(family, result.basis, {}, contact, gammas, 40);
        for (Index k = 20; k < 40; ++k) model.check_unknowns.push_back(1000 * k + 100);
        QuantityOfInterest centre{"u", Vector::Zero(40000), {}};
        centre.displacement[20100] = 1;
        model.quantities = {centre};
        data = build_reduced_model(family, result.basis, model);
    }
};

const Static& trained() {
    static const Static model;
    return model;
}

template <class Query> void each(benchmark::State& state, const Query& query) {
    const std::vector<Parameter>& gammas = trained().gammas;  // trains, before the clock starts
    std::size_t k = 0;
    for (auto _ : state) {
        benchmark::DoNotOptimize(query(gammas[k]));
        k = (k + 1) % gammas.size();
    }
}

void at_by_the_family(benchmark::State& state) {
    each(state, [](const Parameter& gamma) { return trained().result.reduced->at(gamma); });
}
void at_by_series(benchmark::State& state) {
    const ReducedModel model(trained().data);
    state.counters["terms"] = static_cast<double>(trained().data.gap_rows.size());
    state.counters["series"] = static_cast<double>(trained().data.gap.theta.coefficients.cols());
    state.counters["error"] = trained().data.parameter_error;
    each(state, [&](const Parameter& gamma) { return model.at(gamma); });
}
void at_by_few_rows(benchmark::State& state) {
    ExactFunctions exact;
    exact.gap = [](const Parameter& gamma, std::span<const Index> rows, VectorRef out) {
        trained().family.gap(gamma, rows, out);
    };
    const ReducedModel model(trained().data, exact);
    each(state, [&](const Parameter& gamma) { return model.at(gamma); });
}
void solve(benchmark::State& state) {
    const ReducedModel model(trained().data);
    ContactWorkspace workspace(std::make_shared<DenseContact>());
    each(state, [&](const Parameter& gamma) { return solve_static(model.at(gamma), workspace); });
}
void query(benchmark::State& state, bool checked) {
    ReducedModelData data = trained().data;
    if (!checked) data.checks = {};
    Online online(std::make_shared<ReducedModel>(data), {std::make_shared<DenseContact>(), nullptr});
    each(state, [&](const Parameter& gamma) { return online.query(gamma); });
}
void bound(benchmark::State& state) {
    ContactWorkspace workspace(std::make_shared<AutomaticContact>()), reduced(std::make_shared<DenseContact>());
    const StaticErrorBound energy(trained().family, trained().result.basis, CholmodSolver(), workspace);
    const ReducedModel model(trained().data);
    const StaticSolution at = solve_static(model.at(trained().gammas[0]), reduced);
    for (auto _ : state) benchmark::DoNotOptimize(energy(trained().gammas[0], at.u, at.lambda));
}

BENCHMARK(at_by_the_family)->Name("reduced_query/problem/by family")->Unit(benchmark::kMicrosecond);
BENCHMARK(at_by_few_rows)->Name("reduced_query/problem/by few rows")->Unit(benchmark::kMicrosecond);
BENCHMARK(at_by_series)->Name("reduced_query/problem/by series")->Unit(benchmark::kMicrosecond);
BENCHMARK(solve)->Name("reduced_query/solve")->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(query, unchecked, false)->Name("reduced_query/query")->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(query, checked, true)->Name("reduced_query/query checked")->Unit(benchmark::kMicrosecond);
BENCHMARK(bound)->Name("reduced_query/energy bound")->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace tact::bench
