// What a reduced step costs: whole marches of the paper's two dynamic models, per step.
#include <benchmark/benchmark.h>

#include "trained.hpp"

namespace tact::bench {
namespace {

/// The argument says whether gaps are screened.
void march(benchmark::State& state, const Trained& model, const Parameter& gamma, double compliance) {
    ContactWorkspace workspace(std::make_shared<DenseContact>(
        DenseContactOptions{.compliance = compliance, .screening = state.range(0) != 0}));
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

template <Index p> void plates(benchmark::State& state) {
    static const Trained model = trained("two-plates", 40, {p, p}, 1);
    march(state, model, {}, 0);
}
BENCHMARK(plates<40>)->Name("reduced_march/plates/p=40/screening")->DenseRange(0, 1)->Unit(benchmark::kMillisecond);
BENCHMARK(plates<150>)->Name("reduced_march/plates/p=150/screening")->DenseRange(0, 1)->Unit(benchmark::kMillisecond);

void plates_on_selected_rows(benchmark::State& state) {
    static const Trained model = trained("two-plates", 40, {150, 75}, 1, selected_rows());
    march(state, model, {}, 0.3);
}
BENCHMARK(plates_on_selected_rows)
    ->Name("reduced_march/plates/p=150,75 rows, compliance/screening")
    ->DenseRange(0, 1)
    ->Unit(benchmark::kMillisecond);

template <Index p> void membrane(benchmark::State& state) {
    static const Trained model = trained("dynamic-obstacle", 60, {p, p}, 4);
    march(state, model, Eigen::Vector2d(0.41, 0.43), 0);
}
BENCHMARK(membrane<100>)
    ->Name("reduced_march/membrane/p=100/screening")
    ->DenseRange(0, 1)
    ->Unit(benchmark::kMillisecond);

void membrane_on_selected_rows(benchmark::State& state) {
    static const Trained model = trained("dynamic-obstacle", 60, {150, 75}, 4, selected_rows());
    march(state, model, Eigen::Vector2d(0.41, 0.43), 0.3);
}
BENCHMARK(membrane_on_selected_rows)
    ->Name("reduced_march/membrane/p=150,75 rows, compliance/screening")
    ->DenseRange(0, 1)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace tact::bench
