// What a reduced step costs: whole marches of the paper's two dynamic models, per step.
#include <benchmark/benchmark.h>

#include "tact/bench/micro/trained.hpp"

namespace tact::bench {
namespace {

void march(benchmark::State& state, const Trained& model, const Parameter& gamma) {
    ContactWorkspace workspace(std::make_shared<DenseContact>());
    const ContactProblem problem = model.result.reduced->at(gamma);
    long steps = 0;
    for (auto _ : state) {
        const MarchReport report = integrate(*model.scheme.integrator, problem, model.scheme.grid, workspace);
        if (report.outcome != Outcome::converged) state.SkipWithError("the contact solve did not converge");
        steps += report.accepted_steps;
    }
    state.counters["per_step"] =
        benchmark::Counter(static_cast<double>(steps), benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

void plates(benchmark::State& state) {
    static const Trained model = trained("two-plates", 40, 40, 1);
    march(state, model, {});
}
BENCHMARK(plates)->Name("reduced_march/plates/p=40")->Unit(benchmark::kMillisecond);

void membrane(benchmark::State& state) {
    static const Trained model = trained("dynamic-obstacle", 60, 100, 4);
    march(state, model, Eigen::Vector2d(0.41, 0.43));
}
BENCHMARK(membrane)->Name("reduced_march/membrane/p=100")->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace tact::bench
