#include "paper_study.hpp"

#include <algorithm>

#include "../../contact/automatic.hpp"
#include "../../contact/dense/dense_contact.hpp"
#include "../../rom/greedy/construction.hpp"
#include "../../rom/greedy/sampling.hpp"
#include "interrupt.hpp"
#include "progress.hpp"

namespace tact::bench {
namespace {

constexpr int quarter = 4;

PaperStudy static_obstacle(bool small) {
    PaperStudy study{study_scene("static-obstacle", small ? 60 : 0), {}, 865, small ? 20 / quarter : 20, 0};
    study.p = study.samples;
    const ContactFamily& family = *study.scene.family;
    const std::vector<Index> counts = small ? std::vector<Index>{13, 5} : std::vector<Index>{25, 11};
    study.tests = tensor_grid(family.lower(), family.upper(), counts, GridKind::closed);
    return study;
}

PaperStudy dynamic_obstacle(bool small) {
    PaperStudy study{study_scene("dynamic-obstacle", small ? 60 : 0), {}, 302, 10, small ? 100 / quarter : 100};
    const ContactFamily& family = *study.scene.family;
    const std::vector<Index> counts = small ? std::vector<Index>{3, 2} : std::vector<Index>{4, 6};
    study.tests = tensor_grid(family.lower(), family.upper(), counts, GridKind::closed);
    if (!small) study.tests.push_back(Eigen::Vector2d(0.3, 0.288));  // where the paper's own model is worst
    return study;
}

PaperStudy plates(bool small) {
    return {study_scene("two-plates", small ? 40 : 0), {Parameter()}, 2229, 1, small ? 40 / quarter : 40};
}

}  // namespace

const std::vector<std::string>& paper_study_names() {
    static const std::vector<std::string> names{"static-obstacle", "dynamic-obstacle", "two-plates"};
    return names;
}

PaperStudy paper_study(std::string_view name, bool small) {
    if (name == "static-obstacle") return static_obstacle(small);
    if (name == "dynamic-obstacle") return dynamic_obstacle(small);
    if (name == "two-plates") return plates(small);
    throw InputError("paper_study: scene is " + std::string(name) +
                     ", expected static-obstacle, dynamic-obstacle or two-plates");
}

std::vector<std::string> wanted_scenes(const std::string& study, const std::vector<std::string>& wanted) {
    for (const std::string& name : wanted)
        if (std::ranges::find(paper_study_names(), name) == paper_study_names().end())
            throw InputError(study + ": scene is " + name +
                             ", expected static-obstacle, dynamic-obstacle or two-plates");
    std::vector<std::string> names;
    for (const std::string& name : paper_study_names())
        if (wanted.empty() || std::ranges::find(wanted, name) != wanted.end()) names.push_back(name);
    return names;
}

std::vector<Parameter> training_candidates(const PaperStudy& study, GridKind kind) {
    const ContactFamily& family = *study.scene.family;
    if (family.names().empty()) return {};
    const Index side = study.scene.n < 100 ? 5 : 10;
    return tensor_grid(family.lower(), family.upper(), {side, side}, kind);
}

DefaultTraining default_training(const PaperStudy& study) {
    TrainingOptions options;
    options.candidates = training_candidates(study, GridKind::cell_centred);
    if (study.scene.is_static()) {
        options.selection = Selection::in_order;
        options.max_iterations = static_cast<int>(options.candidates.size());
        const Construction construction = static_construction(study.p, options.max_iterations);
        return {construction.applied_to(options), construction.compliance};
    }
    options.max_iterations = study.samples;
    const Index p = study.scene.family->names().empty() ? 15 * study.p / 4 : 3 * study.p / 2;
    const Construction construction = march_construction(p, study.samples);
    return {construction.applied_to(options), construction.compliance};
}

TrainingOptions paper_training(const PaperStudy& study) {
    TrainingOptions options;
    options.candidates = training_candidates(study, GridKind::cell_centred);
    options.max_iterations = study.samples;
    const Construction construction =
        study.scene.is_static() ? paper_static_construction() : paper_march_construction(study.p, study.samples);
    options = construction.applied_to(options);
    return options;
}

TrainingResult train_with_progress(const PaperStudy& study, const TrainingMethod& method, TrainingOptions options,
                                   const std::string& label, double compliance) {
    Progress progress(study.scene.name + ": " + label, options.max_iterations);
    options.observer = [&progress, told = options.observer](const TrainingProgress& at) {
        if (interrupted() || (told && told(at) == Flow::stop)) return Flow::stop;
        // The bar moves with the full runs and the candidates, which take most of an iteration.
        const double share = at.stage == "full run"     ? 0.4 * at.fraction
                             : at.stage == "candidates" ? 0.6 + 0.4 * at.fraction
                                                        : 0.5;
        progress.at(at.iteration - 1 + share);
        return Flow::proceed;
    };
    TrainingResult result = train(study.scene.family, method,
                                  {std::make_shared<AutomaticContact>(),
                                   std::make_shared<DenseContact>(DenseContactOptions{.compliance = compliance})},
                                  options);
    throw_if_interrupted();
    if (result.outcome != Outcome::converged)
        throw NumericalError(study.scene.name + ": " + label + ": " + std::string(to_string(result.reason)) +
                             " at step " + std::to_string(result.failed_step) + " with " +
                             std::string(to_string(result.outcome)));
    return result;
}

std::vector<Parameter> samples_of(const TrainingResult& trained) {
    std::vector<Parameter> samples;
    for (const TrainingIteration& iteration : trained.history) samples.push_back(iteration.gamma);
    return samples;
}

std::vector<Parameter> without(const std::vector<Parameter>& gammas, const std::vector<Parameter>& samples) {
    std::vector<Parameter> rest;
    for (const Parameter& gamma : gammas)
        if (gamma.size() == 0 ||
            std::ranges::none_of(samples, [&](const Parameter& sample) { return (sample - gamma).norm() < 1e-9; }))
            rest.push_back(gamma);
    return rest;
}

}  // namespace tact::bench
