// What internal forces r(u) cost: a march of two plates without them, and with a weak and a strong cubic force.
#include <benchmark/benchmark.h>

#include <memory>

#include "../../contact/automatic.hpp"
#include "../../integrators/trapezoid.hpp"
#include "../../lib/scenes/plates.hpp"
#include "../../lib/time/stage.hpp"

namespace tact::bench {
namespace {

/// r_i = k u_i^3; nothing for k = 0.
void march(benchmark::State& state, double k) {
    ContactProblem problem = two_plates(30).problem;
    if (k > 0)
        problem.r =
            InternalForce{[k](const ConstVectorRef& u, VectorRef out) { out = k * u.array().cube(); },
                          [k](const ConstVectorRef& u) { return Matrix::diagonal(3 * k * u.array().square()); }};
    for (auto _ : state) {
        ContactWorkspace workspace(std::make_shared<AutomaticContact>());
        const MarchReport report = integrate(Trapezoid{}, problem, TimeGrid{2e-4, 100}, workspace);
        if (report.outcome != Outcome::converged) state.SkipWithError("the march did not converge");
        state.counters["active"] = static_cast<double>(report.most_active);
    }
}

BENCHMARK_CAPTURE(march, none, 0.0)->Name("internal_forces/plates/none")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(march, weak, 1e-6)->Name("internal_forces/plates/weak")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(march, strong, 1e2)->Name("internal_forces/plates/strong")->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace tact::bench
