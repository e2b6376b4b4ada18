// A reduced model to disk and back: the static membrane at the paper's size, and the plates that march.
#include <benchmark/benchmark.h>

#include <filesystem>

#include "../../rom/file/rom_file.hpp"
#include "../../rom/model/build_reduced_model.hpp"
#include "../peers/peer_program.hpp"
#include "trained.hpp"

namespace tact::bench {
namespace {

ReducedModelData membrane() {
    const Trained model = trained("static-obstacle", 200, {20, 20}, 9);
    return build_reduced_model(*model.scene.family, model.result.basis, {});
}
ReducedModelData plates() {
    const Trained model = trained("two-plates", 20, {40, 40}, 1);
    ReducedModelOptions options;
    options.method = {model.scheme.integrator->name(), model.scheme.grid};
    return build_reduced_model(*model.scene.family, model.result.basis, options);
}

const ReducedModelData& built(ReducedModelData (*make)()) {
    static std::vector<std::pair<ReducedModelData (*)(), ReducedModelData>> all;
    for (const auto& [by, model] : all)
        if (by == make) return model;
    return all.emplace_back(make, make()).second;
}

void save(benchmark::State& state, ReducedModelData (*make)()) {
    const ReducedModelData& model = built(make);
    const TemporaryFolder folder;
    const std::filesystem::path path = folder.path() / "model";
    for (auto _ : state) save_reduced_model(path, model);
    state.counters["bytes"] = static_cast<double>(std::filesystem::file_size(path));
}
void load(benchmark::State& state, ReducedModelData (*make)()) {
    const TemporaryFolder folder;
    const std::filesystem::path path = folder.path() / "model";
    save_reduced_model(path, built(make));
    for (auto _ : state) benchmark::DoNotOptimize(load_reduced_model(path));
    state.counters["bytes"] = static_cast<double>(std::filesystem::file_size(path));
}

BENCHMARK_CAPTURE(save, membrane, membrane)->Name("rom_file/save/membrane")->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(load, membrane, membrane)->Name("rom_file/load/membrane")->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(save, plates, plates)->Name("rom_file/save/plates")->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(load, plates, plates)->Name("rom_file/load/plates")->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace tact::bench
