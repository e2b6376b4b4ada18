#include "speedup.hpp"

#include <algorithm>
#include <cstdlib>
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

/// Adds to `full` what one slow solver takes for a whole run.
void add_slow_solver(Json& full, const PaperStudy& study, const std::string& field, const std::string& label,
                     const ContactSolver* solver, const SampledMarch& sampled, int repeats) {
    full[field + "_seconds"] = nullptr;
    if (!solver) return;
    repeats = std::min(repeats, sampled_repeats);
    Progress progress(study.scene.name + ": " + label, static_cast<double>(sampled.samples.size()));
    const Replay replayed = replay(*solver, sampled.samples, repeats, progress);
    full[field + "_seconds"] = whole_run(replayed, sampled);
    full[field + "_max_difference"] = replayed.worst_difference;
    full[field + "_not_converged"] = replayed.not_converged;
    if (!sampled.how.empty())
        full["extrapolated"].push_back(
            {{"field", field + "_seconds"}, {"how", sampled.how + "; medians of " + std::to_string(repeats)}});
}

/// What the full runs say: the same beside every reduced model.
Json full_fields(const PaperStudy& study, const Scheme& scheme, const std::vector<Parameter>& queries,
                 ContactWorkspace& workspace, int repeats) {
    const FullTimes times = full_times(study, scheme, queries, workspace);
    const SampledMarch sampled = sample(study, scheme, queries);
    Json full{{"full_seconds", times.warm},
              {"full_cold_seconds", times.cold},
              {"full_method", times.last.strategy},
              {"extrapolated", Json::array()}};
    add_slow_solver(full, study, "full_klu_refactor", "KLU refactorisation", std::make_unique<KluActiveSet>().get(),
                    sampled, repeats);
    add_slow_solver(full, study, "interior_point", "interior point", interior_point().get(), sampled, repeats);
    return full;
}

Json ratio(const Json& seconds, double reduced) {
    return seconds.is_number() ? Json(seconds.get<double>() / reduced) : Json();
}

/// A reduced model and how it was made.
struct Trained {
    std::string method;  ///< "ours" or "the paper's"
    double compliance = 0, seconds = 0;
    TrainingResult result = {};
};

std::vector<Trained> train_all(const PaperStudy& study, const Scheme& scheme, const std::string& bases) {
    std::vector<Trained> all;
    const auto add = [&](const std::string& method, const DefaultTraining& training) {
        Trained trained{.method = method, .compliance = training.compliance};
        trained.seconds = seconds_of([&] {
            trained.result = train_with_progress(study, {scheme.integrator, scheme.grid}, training.options,
                                                 "training, " + method, training.compliance);
        });
        all.push_back(std::move(trained));
    };
    if (bases != "paper") add("ours", default_training(study));
    if (bases != "default") add("the paper's", {paper_training(study), 0});
    return all;
}

Json row_of(const PaperStudy& study, const Scheme& scheme, const Trained& trained, const Json& full,
            const std::vector<Parameter>& tests, ContactWorkspace& full_workspace, int repeats) {
    const StudyScene& scene = study.scene;
    const ContactFamily& reduced_family = *trained.result.reduced;
    ContactWorkspace workspace(std::make_shared<DenseContact>(DenseContactOptions{.compliance = trained.compliance}));
    const double reduced = reduced_seconds(reduced_family, scheme, tests, repeats, workspace);
    const WorstErrors worst =
        worst_errors(scene, scheme, trained.result.basis, reduced_family, tests, full_workspace, workspace);

    const ContactProblem problem = scene.family->at(tests.front());
    Json row;
    row["scene"] = scene.name;
    row["method"] = trained.method;
    row["unknowns"] = problem.size();
    row["contact_constraints"] = problem.constraints();
    row["steps"] = scheme.steps();
    row["p"] = trained.result.basis.primal_size();
    row["p_lambda"] = trained.result.basis.dual_size();
    row["compliance"] = trained.compliance;
    for (const char* field :
         {"full_seconds", "full_cold_seconds", "full_method", "full_klu_refactor_seconds", "interior_point_seconds"})
        row[field] = full[field];
    row["reduced_seconds"] = reduced;
    row["reduced_seconds_per_step"] = reduced / static_cast<double>(scheme.steps());
    row["training_seconds"] = trained.seconds;
    row["training_samples"] = trained.result.history.size();
    row["speedup"] = ratio(full["full_seconds"], reduced);
    row["speedup_vs_klu_refactor"] = ratio(full["full_klu_refactor_seconds"], reduced);
    row["speedup_vs_interior_point"] = ratio(full["interior_point_seconds"], reduced);
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
    for (const auto& [field, value] : full.items())
        if (!row.contains(field)) row[field] = value;
    return row;
}

/// A row a reduced model; full runs and test parameters are the same for all of them.
void add_rows(Json& rows, const PaperStudy& study, const SpeedupOptions& options) {
    const Scheme scheme = paper_scheme(study.scene);
    const std::vector<Trained> all = train_all(study, scheme, options.bases);
    std::vector<Parameter> tests = study.tests;
    for (const Trained& trained : all) tests = without(tests, samples_of(trained.result));
    ContactWorkspace workspace(std::make_shared<AutomaticContact>());
    const Json full = full_fields(study, scheme, timed_queries(tests, options.repeats), workspace, options.repeats);
    for (const Trained& trained : all)
        rows.push_back(row_of(study, scheme, trained, full, tests, workspace, options.repeats));
}

/// Processes that run or wait to, the mean over the last minute; null where the system does not say.
Json load_average() {
    double load = 0;
    return getloadavg(&load, 1) == 1 ? Json(load) : Json();
}

}  // namespace

Json run_speedup(const SpeedupOptions& options) {
    if (options.repeats < 1)
        throw InputError("speedup: repeats is " + std::to_string(options.repeats) + ", expected at least 1");
    if (options.bases != "both" && options.bases != "default" && options.bases != "paper")
        throw InputError("speedup: bases is " + options.bases + ", expected both, default or paper");
    Json json;
    json["study"] = "speedup";
    json["size"] = options.small ? "small" : "full";
    json["repeats"] = options.repeats;
    json["bases"] = options.bases;
    json["machine"] = machine();
    json["rows"] = Json::array();
    for (const std::string& name : wanted_scenes("speedup", options.scenes))
        add_rows(json["rows"], paper_study(name, options.small), options);
    json["load_average"] = load_average();
    return json;
}

}  // namespace tact::bench
