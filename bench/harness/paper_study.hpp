// The paper's three problems with the parameters they are trained and tested at.
#pragma once

#include <string_view>

#include "../../rom/greedy/greedy.hpp"
#include "../../rom/greedy/sampling.hpp"
#include "scenes.hpp"

namespace tact::bench {

struct PaperStudy {
    StudyScene scene;
    std::vector<Parameter> tests;
    double paper_speedup = 0;  ///< its Table I
    int samples = 1;           ///< full runs of the paper's training
    Index p = 0;               ///< after them
};

/// static-obstacle, dynamic-obstacle or two-plates. `small`: membrane 60 x 60, plates 40 x 40, bases and tests a quarter.
/// InputError that lists the names for another one.
PaperStudy paper_study(std::string_view name, bool small);
const std::vector<std::string>& paper_study_names();

/// `wanted`, or all where it is empty; InputError, in the name of `study`, for a name that is none.
std::vector<std::string> wanted_scenes(const std::string& study, const std::vector<std::string>& wanted);

/// The candidates of greedy training, 10 x 10 (small: 5 x 5); one without parameters.
std::vector<Parameter> training_candidates(const PaperStudy& study, GridKind kind);

/// Our own: contact at selected rows (march_construction, static_construction). In marches the paper's greedy search with
/// half as many modes again, in statics all candidates. `compliance` is for the reduced contact solver.
struct DefaultTraining {
    TrainingOptions options;
    double compliance = 0;
};
DefaultTraining default_training(const PaperStudy& study);

/// The paper's training, Algorithm 2, of that study: candidates cell-centred, NNMF, BDF2.
TrainingOptions paper_training(const PaperStudy& study);

/// train() with a progress bar, ended by a signal. NumericalError where training fails; Interrupted.
TrainingResult train_with_progress(const PaperStudy& study, const TrainingMethod& method, TrainingOptions options,
                                   const std::string& label = "training", double compliance = 0);

/// The parameters training sampled, in their order.
std::vector<Parameter> samples_of(const TrainingResult& trained);
/// The parameters of `gammas` that are none of `samples`; of a scene without parameters, its one.
std::vector<Parameter> without(const std::vector<Parameter>& gammas, const std::vector<Parameter>& samples);

}  // namespace tact::bench
