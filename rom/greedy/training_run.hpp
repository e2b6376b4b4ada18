// One run of training: a march, or a static solution in its shape.
#pragma once

#include <memory>

#include "../../lib/time/integrator.hpp"

namespace tact {

/// How full and reduced problems are marched; without an integrator they are static, and the grid is not read.
struct TrainingMethod {
    std::shared_ptr<const Integrator> integrator;
    TimeGrid grid;
};

/// A march, or a static solution, told to the observers as a state at step 0.
MarchReport run_by(const TrainingMethod& method, const ContactProblem& problem, const ContactWorkspace& workspace,
                   std::span<const Observer> observers);

}  // namespace tact
