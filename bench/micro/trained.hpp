// Small trained models that the micro-benchmarks step.
#pragma once

#include <memory>

#include "../../contact/automatic.hpp"
#include "../../contact/dense/dense_contact.hpp"
#include "../../rom/greedy/greedy.hpp"
#include "../../rom/greedy/sampling.hpp"
#include "../harness/measure.hpp"
#include "../harness/scenes.hpp"

namespace tact::bench {

/// A scene at small size with a basis of the paper's size: a reduced step costs the same whatever the full size was.
struct Trained {
    StudyScene scene;
    Scheme scheme;
    TrainingResult result;
};

inline Trained trained(const char* name, Index n, BasisSizes sizes, int samples,
                       DualBasis dual_basis = nnmf_basis()) {
    Trained model{study_scene(name, n), {}, {}};
    model.scheme = paper_scheme(model.scene);
    const ContactFamily& family = *model.scene.family;
    TrainingOptions options;
    options.max_iterations = samples;
    options.sizes = [sizes](int) { return sizes; };
    options.dual_basis = std::move(dual_basis);
    if (!family.names().empty()) options.candidates = tensor_grid(family.lower(), family.upper(), {3, 3});
    model.result = train(model.scene.family, {model.scheme.integrator, model.scheme.grid},
                         {std::make_shared<AutomaticContact>(), std::make_shared<DenseContact>()}, options);
    return model;
}

}  // namespace tact::bench
