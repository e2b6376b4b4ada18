// What one full contact solve costs at full size: a step in contact from each march, from the state before it.
#include <benchmark/benchmark.h>

#include "../../contact/automatic.hpp"
#include "../../contact/strategies/klu_active_set.hpp"
#include "../harness/measure.hpp"

namespace tact::bench {
namespace {

SampledSolve step_in_contact(const char* name, const Parameter& gamma, long step) {
    const StudyScene scene = study_scene(name);
    Scheme scheme = paper_scheme(scene);
    scheme.grid.steps = step + 1;
    std::vector<SampledSolve> samples;
    ContactWorkspace workspace(
        std::make_shared<SampledContact>(std::make_shared<AutomaticContact>(), std::vector{step}, samples));
    (void)run(name, scene.family->at(gamma), scheme, workspace);
    return samples.front();
}

void solve(benchmark::State& state, const ContactSolver& solver, const SampledSolve& sample) {
    const auto prepared = solver.prepare(sample.A, sample.B);
    Vector u, lambda;
    for (auto _ : state) {
        u = sample.u;
        lambda = sample.lambda;
        const ContactReport report = prepared->solve(sample.b, sample.c, {u, lambda});
        if (report.outcome != Outcome::converged) state.SkipWithError("the contact solve did not converge");
        state.counters["active"] = static_cast<double>(report.active);
    }
}

const SampledSolve& membrane() {
    static const SampledSolve sample = step_in_contact("dynamic-obstacle", Eigen::Vector2d(0.6, 0.6), 80);
    return sample;
}
const SampledSolve& plates() {
    static const SampledSolve sample = step_in_contact("two-plates", {}, 40);
    return sample;
}

void membrane_automatic(benchmark::State& state) { solve(state, AutomaticContact(), membrane()); }
void membrane_klu(benchmark::State& state) { solve(state, KluActiveSet(), membrane()); }
void plates_automatic(benchmark::State& state) { solve(state, AutomaticContact(), plates()); }
void plates_klu(benchmark::State& state) { solve(state, KluActiveSet(), plates()); }
BENCHMARK(membrane_automatic)->Name("stage_solve/membrane/automatic")->Unit(benchmark::kMillisecond);
BENCHMARK(membrane_klu)->Name("stage_solve/membrane/klu")->Unit(benchmark::kMillisecond);
BENCHMARK(plates_automatic)->Name("stage_solve/plates/automatic")->Unit(benchmark::kMillisecond);
BENCHMARK(plates_klu)->Name("stage_solve/plates/klu")->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace tact::bench
