#include "speedup.hpp"

#include <algorithm>
#include <numeric>

#include "../../../contact/automatic.hpp"
#include "../../../contact/dense/dense_contact.hpp"
#include "../../../contact/strategies/klu_active_set.hpp"
#include "../../harness/measure.hpp"
#include "../../harness/paper_study.hpp"
#include "../../harness/reference_runs.hpp"
#include "../../harness/timing.hpp"
#include "../../peers/interior_point.hpp"

namespace tact::bench {
namespace {

constexpr long sampled_in_contact = 6;  // steps of a march, for the slow solvers
constexpr long sampled_free = 4;
constexpr int sampled_repeats = 3;  // of each, at most: they cost seconds

/// Queries to time: `count` of the tests, spread over them; the only one again and again where there is one.
std::vector<Parameter> timed_queries(const std::vector<Parameter>& tests, int count) {
    std::vector<Parameter> queries;
    for (const long k : spread(count, static_cast<long>(tests.size())))
        queries.push_back(tests[static_cast<std::size_t>(k)]);
    while (static_cast<int>(queries.size()) < count) queries.push_back(queries.back());
    return queries;
}

/// CPU seconds of one online query, the evaluation of the gap included: all tests in turn, so that single queries of
/// microseconds add up to what the clock resolves.
double reduced_seconds(const ContactFamily& reduced, const Scheme& scheme, const std::vector<Parameter>& tests,
                       int repeats, ContactWorkspace& workspace) {
    const auto all = [&] {
        for (const Parameter& gamma : tests) (void)run("reduced", reduced.at(gamma), scheme, workspace);
    };
    all();  // prepares the workspace: offline
    const int loops = std::max(1, static_cast<int>(0.02 / std::max(seconds_of(all), 1e-6)));
    return median_seconds(repeats,
                          [&] {
                              for (int k = 0; k < loops; ++k) all();
                          }) /
           (loops * static_cast<double>(tests.size()));
}

struct FullTimes {
    double cold = 0, warm = 0;
    RunSummary last;
};

FullTimes full_times(const PaperStudy& study, const Scheme& scheme, const std::vector<Parameter>& queries,
                     ContactWorkspace& workspace) {
    const ContactFamily& family = *study.scene.family;
    Progress progress(study.scene.name + ": full runs", 2 * static_cast<double>(queries.size()));
    FullTimes times;
    std::vector<double> cold, warm;
    for (const Parameter& gamma : queries) {
        ContactWorkspace fresh(std::make_shared<AutomaticContact>());
        cold.push_back(seconds_of([&] { times.last = run(study.scene.name, family.at(gamma), scheme, fresh); }));
        progress.add(1);
    }
    (void)run(study.scene.name, family.at(study.tests.front()), scheme,
              workspace);  // the run that fills it: not counted
    for (const Parameter& gamma : queries) {
        warm.push_back(seconds_of([&] { times.last = run(study.scene.name, family.at(gamma), scheme, workspace); }));
        progress.add(1);
    }
    times.cold = median(cold);
    times.warm = median(warm);
    return times;
}

/// What the slow solvers are timed on: single solves in statics, sampled steps of a march.
SampledMarch sample(const PaperStudy& study, const Scheme& scheme, const std::vector<Parameter>& queries) {
    const std::string& name = study.scene.name;
    if (scheme.integrator)
        return sample_march(name, study.scene.family->at(queries.front()), scheme, sampled_in_contact, sampled_free);
    SampledMarch sampled;
    std::vector<long> numbers(queries.size());
    std::iota(numbers.begin(), numbers.end(), 0);
    ContactWorkspace workspace(
        std::make_shared<SampledContact>(std::make_shared<AutomaticContact>(), numbers, sampled.samples));
    for (const Parameter& gamma : queries) (void)run(name, study.scene.family->at(gamma), scheme, workspace);
    return sampled;
}

/// A whole run from its sampled solves.
double whole_run(const Replay& replayed, const SampledMarch& sampled) {
    if (sampled.stands_for.empty()) return median(replayed.seconds);
    return std::inner_product(replayed.seconds.begin(), replayed.seconds.end(), sampled.stands_for.begin(), 0.0);
}

Json compare(Json& row, const std::string& field, const std::string& label, const ContactSolver* solver,
             const SampledMarch& sampled, int repeats) {
    if (!solver) return nullptr;
    repeats = std::min(repeats, sampled_repeats);
    Progress progress(row["scene"].get<std::string>() + ": " + label, static_cast<double>(sampled.samples.size()));
    const Replay replayed = replay(*solver, sampled.samples, repeats, progress);
    row[field + "_max_difference"] = replayed.worst_difference;
    row[field + "_not_converged"] = replayed.not_converged;
    if (!sampled.how.empty())
        row["extrapolated"].push_back(
            {{"field", field + "_seconds"}, {"how", sampled.how + "; medians of " + std::to_string(repeats)}});
    return whole_run(replayed, sampled);
}

Json ratio(const Json& seconds, double reduced) {
    return seconds.is_number() ? Json(seconds.get<double>() / reduced) : Json();
}

Json row_of(const PaperStudy& study, const std::string& bases, int repeats) {
    const StudyScene& scene = study.scene;
    const Scheme scheme = paper_scheme(scene);
    const DefaultTraining training =
        bases == "paper" ? DefaultTraining{paper_training(study), 0} : default_training(study);
    TrainingResult trained;
    const double training_seconds = seconds_of([&] {
        trained = train_with_progress(study, {scheme.integrator, scheme.grid}, training.options, "training",
                                      training.compliance);
    });
    const std::vector<Parameter> tests = without(study.tests, samples_of(trained));
    const std::vector<Parameter> queries = timed_queries(tests, repeats);

    ContactWorkspace full_workspace(std::make_shared<AutomaticContact>());
    ContactWorkspace reduced_workspace(
        std::make_shared<DenseContact>(DenseContactOptions{.compliance = training.compliance}));
    const FullTimes full = full_times(study, scheme, queries, full_workspace);
    const double reduced = reduced_seconds(*trained.reduced, scheme, tests, repeats, reduced_workspace);
    const WorstErrors worst =
        worst_errors(scene, scheme, trained.basis, *trained.reduced, tests, full_workspace, reduced_workspace);
    const SampledMarch sampled = sample(study, scheme, queries);

    const ContactProblem problem = scene.family->at(tests.front());
    Json row;
    row["scene"] = scene.name;
    row["unknowns"] = problem.size();
    row["contact_constraints"] = problem.constraints();
    row["steps"] = scheme.steps();
    row["p"] = trained.basis.primal_size();
    row["p_lambda"] = trained.basis.dual_size();
    row["compliance"] = training.compliance;
    row["full_seconds"] = full.warm;
    row["full_cold_seconds"] = full.cold;
    row["full_method"] = full.last.strategy;
    row["full_klu_refactor_seconds"] = nullptr;  // here for the order of the fields
    row["interior_point_seconds"] = nullptr;
    row["reduced_seconds"] = reduced;
    row["reduced_seconds_per_step"] = reduced / static_cast<double>(scheme.steps());
    row["training_seconds"] = training_seconds;
    row["training_samples"] = trained.history.size();
    row["speedup"] = full.warm / reduced;
    row["speedup_vs_klu_refactor"] = nullptr;
    row["speedup_vs_interior_point"] = nullptr;
    row["paper_speedup"] = study.paper_speedup;
    row["relative_error_percent"] = worst.squared_percent;
    row["relative_error_norm"] = worst.norm_percent / 100;
    row["median_relative_error_percent"] = worst.median_squared_percent;
    row["error_over"] = scene.family->names().empty()
                            ? "the training run itself (reproductive)"
                            : "the worst of " + std::to_string(tests.size()) + " parameters outside the training set";
    row["test_parameters"] = tests.size();
    row["worst_parameter"] = std::vector<double>(worst.worst_gamma.begin(), worst.worst_gamma.end());
    row["max_penetration"] = worst.penetration;
    row["max_penetration_over_gap_scale"] = worst.penetration_share;
    row["max_kkt_residual_full"] = worst.worst_kkt_full;
    row["max_kkt_residual_reduced"] = worst.worst_kkt_reduced;
    row["extrapolated"] = Json::array();

    row["full_klu_refactor_seconds"] = compare(row, "full_klu_refactor", "KLU refactorisation",
                                               std::make_unique<KluActiveSet>().get(), sampled, repeats);
    const auto ipopt = interior_point();
    row["interior_point_seconds"] = compare(row, "interior_point", "interior point", ipopt.get(), sampled, repeats);
    row["speedup_vs_klu_refactor"] = ratio(row["full_klu_refactor_seconds"], reduced);
    row["speedup_vs_interior_point"] = ratio(row["interior_point_seconds"], reduced);
    return row;
}

}  // namespace

Json run_speedup(const SpeedupOptions& options) {
    if (options.repeats < 1)
        throw InputError("speedup: repeats is " + std::to_string(options.repeats) + ", expected at least 1");
    if (options.bases != "default" && options.bases != "paper")
        throw InputError("speedup: bases is " + options.bases + ", expected default or paper");
    Json json;
    json["study"] = "speedup";
    json["size"] = options.small ? "small" : "full";
    json["repeats"] = options.repeats;
    json["bases"] = options.bases;
    json["machine"] = machine();
    json["rows"] = Json::array();
    for (const std::string& name : wanted_scenes("speedup", options.scenes))
        json["rows"].push_back(row_of(paper_study(name, options.small), options.bases, options.repeats));
    return json;
}

}  // namespace tact::bench
