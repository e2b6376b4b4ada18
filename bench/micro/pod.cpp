// POD of 40,000 x 800 snapshots by each method, and what its modes, range(0) of them, lose of their norm.
#include "../../rom/bases/pod.hpp"

#include <benchmark/benchmark.h>

#include "../../contact/automatic.hpp"
#include "../../integrators/sundials/bdf2.hpp"
#include "../../lib/scenes/membrane.hpp"
#include "../../rom/bases/pod_accumulator.hpp"

namespace {

using namespace tact;

/// Two runs of the membrane.
const DenseMatrix& snapshots() {
    static const DenseMatrix X = [] {
        const MembraneFamily family(200, Motion::dynamic);
        const TimeGrid grid{0.005, 400};
        ContactWorkspace workspace(std::make_shared<AutomaticContact>());
        DenseMatrix states(200 * 200, 2 * grid.steps);
        for (const Index run : {0, 1}) {
            const std::vector<Observer> record{[&](const State& state, const StepReport&) {
                if (state.step > 0) states.col(run * grid.steps + state.step - 1) = state.u();
                return Flow::proceed;
            }};
            (void)integrate(Bdf2(), family.at(Eigen::Vector2d(0.4, 0.3 + 0.2 * static_cast<double>(run))), grid,
                            workspace, record);
        }
        return states;
    }();
    return X;
}

void report_loss(benchmark::State& state, const DenseMatrix& U) {
    const DenseMatrix& X = snapshots();
    state.counters["lost"] = (X - U * (U.transpose() * X)).norm() / X.norm();
}

void method_of_snapshots(benchmark::State& state) {
    const DenseMatrix& X = snapshots();
    Pod found;
    for (auto _ : state) found = pod(X, {.rank = state.range(0)});
    report_loss(state, found.modes);
}

/// range(1): power iterations.
void sketch(benchmark::State& state) {
    const DenseMatrix& X = snapshots();
    PodOptions options{.rank = state.range(0)};
    options.sketch = RandomisedSketch{.power_iterations = static_cast<int>(state.range(1))};
    Pod found;
    for (auto _ : state) found = pod(X, options);
    report_loss(state, found.modes);
}

void accumulated(benchmark::State& state) {
    const DenseMatrix& X = snapshots();
    Pod found;
    for (auto _ : state) {
        PodAccumulator accumulator({.max_vectors = 2 * state.range(0)});
        accumulator.add(X);
        found = accumulator.modes(state.range(0));
    }
    report_loss(state, found.modes);
}

BENCHMARK(method_of_snapshots)->Arg(20)->Arg(100)->Unit(benchmark::kMillisecond);
BENCHMARK(sketch)->ArgsProduct({{20, 100}, {0, 1, 2}})->Unit(benchmark::kMillisecond);
BENCHMARK(accumulated)->Arg(20)->Arg(100)->Unit(benchmark::kMillisecond);

}  // namespace
