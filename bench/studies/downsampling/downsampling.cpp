#include "downsampling.hpp"

#include <cmath>
#include <list>

#include "../../../lib/time/trajectory.hpp"
#include "../../harness/basis_errors.hpp"
#include "../../harness/interrupt.hpp"
#include "../../harness/paper_study.hpp"
#include "../../harness/timing.hpp"

namespace tact::bench {
namespace {

const std::string strided = "every k-th step", strided_primal = "every k-th step, all multipliers",
                  tolerance = "tolerance";

/// What one selection keeps of the run.
struct Kept {
    Kept(const ContactProblem& problem, long steps, const SnapshotSelection& selection_, Index most)
        : selection(selection_),
          dual(problem.constraints()),
          primal({.max_vectors = 5 * most}),
          recorder(problem.size(), steps, selection, dual, [this](const auto& block) { primal.add(block); }) {}
    SnapshotSelection selection;
    DualSnapshots dual;
    PodAccumulator primal;
    SnapshotRecorder recorder;
};

struct FullRun {
    FullStates states;
    std::list<Kept> kept;  // recorders stay where they are
};

/// One march that all selections watch.
FullRun watched_run(const PaperStudy& study, const Scheme& scheme, const ContactProblem& problem,
                    const std::vector<SnapshotSelection>& selections, Index most) {
    FullRun full;
    Trajectory trajectory(problem, scheme.grid.steps, {.stride = 1, .initial = true, .multipliers = false});
    std::vector<Observer> observers{trajectory.observer()};
    for (const SnapshotSelection& selection : selections)
        observers.push_back(full.kept.emplace_back(problem, scheme.grid.steps, selection, most).recorder.observer());
    Progress progress(study.scene.name + ": full run", static_cast<double>(scheme.grid.steps));
    observers.emplace_back([&](const State&, const StepReport&) {
        progress.add(1);
        return Flow::proceed;
    });
    ContactWorkspace workspace(study_contact().full);
    (void)run(study.scene.name, problem, scheme, workspace, observers);
    for (Kept& kept : full.kept) kept.recorder.flush();
    full.states = {{Parameter()}, trajectory.u()};
    return full;
}

Json row_of(const PaperStudy& study, const Scheme& scheme, const FullRun& full, const Kept& kept,
            const DualSnapshots& dual, const std::string& selection, Index p) {
    const ContactFamily& family = *study.scene.family;
    const BasisRecipe recipe{
        .sizes = {std::min(p, kept.primal.snapshots()), p}, .dual_basis = nnmf_basis(), .supremizers = {}};
    const CompressedBasis built =
        compressed_basis(family.at({}), kept.primal, dual, recipe, [](double) { return !interrupted(); });
    throw_if_interrupted();
    const TestedBasis basis{built.basis.U, reduce(study.scene.family, built.basis)};
    const double percent = squared_percents(basis, scheme, full.states).front();
    Json row{{"selection", selection}, {"stride", nullptr}, {"tolerance", nullptr}};
    if (selection == tolerance)
        row["tolerance"] = kept.selection.tolerance;
    else
        row["stride"] = kept.selection.primal;
    row["snapshots"] = kept.primal.snapshots();
    row["share_percent"] =
        100 * static_cast<double>(kept.primal.snapshots()) / static_cast<double>(scheme.grid.steps);
    row["dual_snapshots"] = dual.size();
    row["p_wanted"] = p;
    row["p"] = built.basis.primal_size();
    row["p_lambda"] = built.basis.dual_size();
    row["relative_error_percent"] = percent;
    row["relative_error_norm"] = std::sqrt(percent / 100);
    return row;
}

double median_error(const Json& rows, const std::string& selection, long stride) {
    std::vector<double> errors;
    for (const Json& row : rows)
        if (row["selection"] == selection && row["stride"] == stride)
            errors.push_back(row["relative_error_percent"].get<double>());
    return median(errors);
}

Json claims_of(const Json& rows, long tenth, long last) {
    const double all = median_error(rows, strided, 1), at_tenth = median_error(rows, strided, tenth);
    const double at_last = median_error(rows, strided, last),
                 multipliers_kept = median_error(rows, strided_primal, last);
    constexpr double insensitive = 1.5, sharp = 5;  // times the error with all snapshots
    return Json::array(
        {{{"claim",
           "the error is insensitive until 10 % of the snapshots: error there over that of all, squared as printed"},
          {"paper", "about 1"},
          {"figure", at_tenth / all},
          {"holds", at_tenth < insensitive * all}},
         {{"claim",
           "with 25 equally spaced snapshots it rises sharply: error of u against the training run, %, squared as "
           "printed"},
          {"paper", "52.8"},
          {"figure", at_last},
          {"holds", at_last > sharp * all}},
         {{"claim",
           "it rises as sharply with all multipliers kept: error of u against the training run, %, squared as "
           "printed"},
          {"paper", "-"},
          {"figure", multipliers_kept},
          {"holds", multipliers_kept > sharp * all}}});
}

}  // namespace

Json run_downsampling(const StudyOptions& options) {
    const PaperStudy study = paper_study("two-plates", options.small);
    check_scenes("downsampling", options, {study.scene.name});
    const Scheme scheme = paper_scheme(study.scene);
    const ContactProblem problem = study.scene.family->at({});
    const std::vector<long> strides =
        options.small ? std::vector<long>{1, 10, 80} : std::vector<long>{1, 2, 4, 5, 8, 10, 16, 20, 32, 40, 80};
    const std::vector<double> tolerances =
        options.small ? std::vector{0.1, 0.4} : std::vector{0.03, 0.05, 0.1, 0.2, 0.4, 0.7};
    const Index centre = study.p, spread = options.small ? 1 : 2;

    std::vector<SnapshotSelection> selections;
    for (const long stride : strides) selections.push_back({.primal = stride, .dual = stride});
    for (const double fraction : tolerances) selections.push_back({.tolerance = fraction});
    const FullRun full = watched_run(study, scheme, problem, selections, centre + spread);

    Json json;
    json["study"] = "downsampling";
    json["size"] = options.small ? "small" : "full";
    json["machine"] = machine();
    json["rows"] = Json::array();
    Progress progress(study.scene.name + ": bases", static_cast<double>(full.kept.size() * (2 * spread + 1)));
    for (const Kept& kept : full.kept)
        for (Index p = centre - spread; p <= centre + spread; ++p) {
            const bool by_tolerance = kept.selection.tolerance > 0;
            json["rows"].push_back(
                row_of(study, scheme, full, kept, kept.dual, by_tolerance ? tolerance : strided, p));
            if (!by_tolerance)
                json["rows"].push_back(row_of(study, scheme, full, kept, full.kept.front().dual, strided_primal, p));
            progress.add(1);
        }
    json["claims"] = claims_of(json["rows"], 10, 80);
    return json;
}

}  // namespace tact::bench
