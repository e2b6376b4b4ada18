// What training costs piece by piece on the snapshots of one march of the paper's membrane: 40,000 x 400 displacements, and the
// multipliers of the rows it touches.
#include <benchmark/benchmark.h>

#include "../../contact/automatic.hpp"
#include "../../contact/dense/dense_contact.hpp"
#include "../../rom/bases/compressed_basis.hpp"
#include "../../rom/bases/gram.hpp"
#include "../../rom/bases/nnmf.hpp"
#include "../../rom/error/indicator.hpp"
#include "../../rom/model/reduce.hpp"
#include "../harness/measure.hpp"

namespace tact::bench {
namespace {

struct Snapshots {
    StudyScene scene = study_scene("dynamic-obstacle");
    Parameter gamma = Eigen::Vector2d(0.6, 0.6);
    Scheme scheme = paper_scheme(scene);
    ContactProblem problem = scene.family->at(gamma);
    DenseMatrix X;
    PodAccumulator primal{{.max_vectors = 200}};
    DualSnapshots dual{problem.constraints()};

    Snapshots() {
        SnapshotRecorder recorder(problem.size(), scheme.grid.steps, {}, dual, [this](const auto& block) {
            X.conservativeResize(block.rows(), X.cols() + block.cols());
            X.rightCols(block.cols()) = block;
            primal.add(block);
        });
        ContactWorkspace workspace(std::make_shared<AutomaticContact>());
        const std::vector<Observer> record{recorder.observer()};
        (void)integrate(*scheme.integrator, problem, scheme.grid, workspace, record);
        recorder.flush();
    }
};

const Snapshots& snapshots() {
    static const Snapshots all;
    return all;
}

void say_size(benchmark::State& state, Index rows, Index columns) {
    state.counters["rows"] = static_cast<double>(rows);
    state.counters["columns"] = static_cast<double>(columns);
}

/// By SVD up to pod_svd_size columns, by the method of snapshots beyond.
void pod_of(benchmark::State& state) {
    const Index columns = std::min(state.range(0), snapshots().X.cols());
    const DenseMatrix X = snapshots().X.rightCols(columns);
    say_size(state, X.rows(), columns);
    for (auto _ : state) benchmark::DoNotOptimize(pod(X));
}
void gram_of(benchmark::State& state) {
    const DenseMatrix& X = snapshots().X;
    say_size(state, X.rows(), X.cols());
    for (auto _ : state) benchmark::DoNotOptimize(gram(X));
}
/// A second march on top of a first.
void accumulate(benchmark::State& state) {
    const DenseMatrix& X = snapshots().X;
    say_size(state, X.rows(), X.cols());
    for (auto _ : state) {
        state.PauseTiming();
        PodAccumulator accumulator = snapshots().primal;
        state.ResumeTiming();
        accumulator.add(X);
    }
}

/// The difference between twelve sweeps and two is ten: starts and the choice of rows cost the same in both.
void nnmf_sweeps(benchmark::State& state, NnmfUpdates updates) {
    const SparseMatrix X = snapshots().dual.matrix();
    say_size(state, X.rows(), X.cols());
    state.counters["rank"] = static_cast<double>(state.range(0));
    NnmfOptions options{.updates = updates, .random = RandomStarts{}, .tolerance = 0};
    options.max_sweeps = static_cast<int>(state.range(1));
    for (auto _ : state) benchmark::DoNotOptimize(nnmf(X, state.range(0), options));
}

/// Eq. 14 over the steps of one reduced run.
void indicator(benchmark::State& state, IndicatorWeights weights) {
    const Snapshots& all = snapshots();
    BasisRecipe recipe;
    recipe.sizes = {40, 40};
    const ReducedBasis basis = compressed_basis(all.problem, all.primal, all.dual, recipe).basis;
    const ContactProblem reduced = reduce(all.problem, basis);
    std::vector<long> steps;
    for (long step = 1; step <= all.scheme.grid.steps; ++step) steps.push_back(step);
    ReducedStateRecorder recorder(steps);
    ContactWorkspace workspace(std::make_shared<DenseContact>());
    const std::vector<Observer> record{recorder.observer(reduced)};
    (void)integrate(*all.scheme.integrator, reduced, all.scheme.grid, workspace, record);
    const Indicator judge(all.scene.family, basis, weights);
    state.counters["steps"] = static_cast<double>(recorder.states().size());
    for (auto _ : state) benchmark::DoNotOptimize(judge(all.gamma, reduced, recorder.states()));
}

BENCHMARK(pod_of)->Name("pod/columns")->Arg(pod_svd_size)->Arg(200)->Arg(400)->Unit(benchmark::kMillisecond);
BENCHMARK(gram_of)->Name("pod/gram")->Unit(benchmark::kMillisecond);
BENCHMARK(accumulate)->Name("pod/accumulate")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(nnmf_sweeps, hierarchical, NnmfUpdates::hierarchical)
    ->Name("nnmf/hierarchical")
    ->ArgNames({"rank", "sweeps"})
    ->ArgsProduct({{40, 100}, {2, 12}})
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(nnmf_sweeps, multiplicative, NnmfUpdates::multiplicative)
    ->Name("nnmf/multiplicative")
    ->ArgNames({"rank", "sweeps"})
    ->ArgsProduct({{40, 100}, {2, 12}})
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(indicator, penetration, IndicatorWeights{1, 0, 0})
    ->Name("indicator/penetration")
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(indicator, all, IndicatorWeights{1, 1, 1})
    ->Name("indicator/all three terms")
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace tact::bench
