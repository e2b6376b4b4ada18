#include "online.hpp"

#include <unistd.h>
#include <algorithm>
#include <filesystem>

#include "../../../contact/automatic.hpp"
#include "../../../contact/dense/dense_contact.hpp"
#include "../../../lib/sparse/cholmod_solver.hpp"
#include "../../../rom/error/static_error_bound.hpp"
#include "../../../rom/file/rom_file.hpp"
#include "../../../rom/greedy/calibration.hpp"
#include "../../../rom/model/online.hpp"
#include "../../harness/interrupt.hpp"
#include "../../harness/measure.hpp"
#include "../../harness/paper_study.hpp"
#include "../../harness/report.hpp"
#include "../../harness/timing.hpp"

namespace tact::bench {
namespace {

constexpr int repeats = 5;

struct Setting {
    PaperStudy study;
    Scheme scheme = {};
    TrainingMethod method = {};
    TrainingContact contact{std::make_shared<AutomaticContact>(), std::make_shared<DenseContact>()};
    std::vector<Parameter> calibration = {}, tests = {};
};

Setting setting(const std::string& name, const StudyOptions& options) {
    Setting s{paper_study(name, options.small), {}, {}};
    s.scheme = paper_scheme(s.study.scene);
    s.method = {s.scheme.integrator, s.scheme.grid};
    const ContactFamily& family = *s.study.scene.family;
    s.calibration = latin_hypercube(family.lower(), family.upper(), options.small ? 12 : 40, 1);
    s.tests = latin_hypercube(family.lower(), family.upper(), options.small ? 12 : 60, 2);
    return s;
}

ReducedModelData calibrated_model(const Setting& s, const TrainingResult& trained, double& seconds) {
    const ContactFamily& family = *s.study.scene.family;
    const Index p = trained.basis.primal_size(), n = trained.basis.U.rows();
    ReducedModelOptions options;
    if (s.method.integrator) options.method = {s.method.integrator->name(), s.method.grid};
    options.check_rows =
        penetrated_rows(s.study.scene.family, trained.basis, s.method, s.contact, s.calibration, 2 * p);
    const Index rows = 2 * p;
    for (Index k = 0; k < rows; ++k) options.check_unknowns.push_back((2 * k + 1) * n / (2 * rows));
    options.training = training_record(trained);
    ReducedModelData data;
    seconds = seconds_of([&] { data = build_reduced_model(family, trained.basis, options); });
    throw_if_interrupted();
    calibrate(data.checks,
              error_samples(family, trained.basis, ReducedModel(data), s.method, s.contact, s.calibration));
    return data;
}

/// CPU microseconds of one call, all parameters in turn.
template <class Work> double microseconds(const std::vector<Parameter>& gammas, const Work& work) {
    const auto all = [&] {
        for (const Parameter& gamma : gammas) work(gamma);
    };
    all();
    const int loops = std::max(1, static_cast<int>(0.02 / std::max(seconds_of(all), 1e-6)));
    return 1e6 / (loops * static_cast<double>(gammas.size())) * median_seconds(repeats, [&] {
               for (int k = 0; k < loops; ++k) all();
           });
}

Json spread_of(std::vector<double> ratios) {
    std::sort(ratios.begin(), ratios.end());
    const auto below = std::count_if(ratios.begin(), ratios.end(), [](double x) { return x < 1; });
    return {{"least", ratios.front()}, {"median", median(ratios)}, {"largest", ratios.back()}, {"below", below}};
}

void add_file(Json& row, const ReducedModelData& data, const Setting& s) {
    const auto path = std::filesystem::temp_directory_path() / ("tact-online-" + std::to_string(::getpid()) + ".rom");
    row["save_seconds"] = seconds_of([&] { save_reduced_model(path, data); });
    row["file_bytes"] = std::filesystem::file_size(path);
    ReducedModelData loaded;
    row["load_seconds"] = seconds_of([&] { loaded = load_reduced_model(path); });
    std::filesystem::remove(path);
    const OnlineMethod method{s.contact.reduced, s.method.integrator};
    Online a(std::make_shared<ReducedModel>(data), method), b(std::make_shared<ReducedModel>(loaded), method);
    bool same = true;
    for (const Parameter& gamma : s.tests) {
        const Answer x = a.query(gamma), y = b.query(gamma);
        same = same && x.state.y == y.state.y && x.state.lambda == y.state.lambda &&
               x.trust.estimate == y.trust.estimate;
    }
    row["same_bits"] = same;
}

void add_times(Json& row, const ReducedModelData& data, const Setting& s) {
    const auto model = std::make_shared<ReducedModel>(data);
    ReducedModelData bare = data;
    bare.checks = {};
    const OnlineMethod method{s.contact.reduced, s.method.integrator};
    Online checked(model, method), unchecked(std::make_shared<ReducedModel>(bare), method);
    row["us_problem"] = microseconds(s.tests, [&](const Parameter& gamma) { return model->at(gamma).size(); });
    row["us_query"] = microseconds(s.tests, [&](const Parameter& gamma) { (void)unchecked.query(gamma); });
    row["us_query_checked"] = microseconds(s.tests, [&](const Parameter& gamma) { (void)checked.query(gamma); });
}

void add_estimate(Json& row, const ReducedModelData& data, const TrainingResult& trained, const Setting& s) {
    const auto samples =
        error_samples(*s.study.scene.family, trained.basis, ReducedModel(data), s.method, s.contact, s.tests);
    std::vector<double> ratios;
    double largest = 0;
    for (const ErrorSample& sample : samples) {
        largest = std::max(largest, sample.error);
        if (sample.error > 0)
            ratios.push_back((data.checks.penetration_weight * sample.penetration +
                              data.checks.residual_weight * sample.residual) /
                             sample.error);
    }
    row["calibrated_on"] = data.checks.calibrated_on;
    row["tests"] = samples.size();
    row["error_percent"] = 100 * largest;
    row["estimate"] = spread_of(std::move(ratios));
}

void add_bound(Json& row, const ReducedModelData& data, const TrainingResult& trained, const Setting& s) {
    row["bound"] = nullptr;
    row["us_bound"] = nullptr;
    if (s.method.integrator) return;
    const ContactFamily& family = *s.study.scene.family;
    ContactWorkspace full(s.contact.full), reduced(s.contact.reduced);
    const StaticErrorBound bound(s.study.scene.family, trained.basis, CholmodSolver(), full);
    const ReducedModel model(data);
    std::vector<double> ratios;
    for (const Parameter& gamma : s.tests) {
        throw_if_interrupted();
        const ContactProblem problem = family.at(gamma);
        const StaticSolution u = solve_static(problem, full), q = solve_static(model.at(gamma), reduced);
        const Vector e = u.u - trained.basis.U * q.u;
        ratios.push_back(bound(gamma, q.u, q.lambda).error / std::sqrt(e.dot(problem.K * e)));
    }
    row["bound"] = spread_of(std::move(ratios));
    const StaticSolution q = solve_static(model.at(s.tests.front()), reduced);
    row["us_bound"] = microseconds(s.tests, [&](const Parameter& gamma) { (void)bound(gamma, q.u, q.lambda); });
}

Json row_of(const Setting& s, int samples) {
    TrainingOptions options = paper_training(s.study);
    options.max_iterations = samples;
    const TrainingResult trained = train_with_progress(s.study, s.method, options);
    double seconds = 0;
    const ReducedModelData data = calibrated_model(s, trained, seconds);
    Json row{{"scene", s.study.scene.name},
             {"n", s.study.scene.n},
             {"samples", samples},
             {"p", trained.basis.primal_size()},
             {"p_lambda", trained.basis.dual_size()},
             {"steps", s.scheme.steps()},
             {"gap_rows", data.gap_rows.size()},
             {"series", data.gap.theta.coefficients.cols()},
             {"parameter_error", data.parameter_error},
             {"build_seconds", seconds},
             {"schur_condition", nullptr}};
    const BasisReport basis = report_basis(data.centre);
    if (basis.schur_condition < infinity) row["schur_condition"] = basis.schur_condition;
    row["schur_rank"] = basis.schur_rank;
    row["inf_sup_constant"] = basis.inf_sup_constant;
    add_file(row, data, s);
    add_times(row, data, s);
    add_estimate(row, data, trained, s);
    add_bound(row, data, trained, s);
    return row;
}

std::vector<std::string> cells(const Json& row) {
    const auto range = [](const Json& ratios) {
        if (ratios.is_null()) return std::string("-");
        return digits(ratios["least"], 2) + " / " + digits(ratios["median"], 2) + " / " +
               digits(ratios["largest"], 2);
    };
    return {row["scene"].get<std::string>(),
            row["p"].dump() + " / " + row["p_lambda"].dump(),
            row["gap_rows"].dump() + " / " + row["series"].dump(),
            digits(row["parameter_error"], 2),
            digits(row["us_problem"]),
            digits(row["us_query"]),
            digits(row["us_query_checked"]),
            digits(1e-6 * row["file_bytes"].get<double>()),
            with_unit(row["load_seconds"]),
            row["same_bits"].get<bool>() ? "yes" : "NO",
            digits(row["error_percent"]),
            range(row["estimate"]),
            row["estimate"]["below"].dump() + " of " + row["tests"].dump(),
            range(row["bound"]),
            digits(row["us_bound"])};
}

}  // namespace

Json run_online(const StudyOptions& options) {
    Json json{{"study", "online"}, {"size", options.small ? "small" : "full"}};
    json["machine"] = machine();
    json["rows"] = Json::array();
    const std::vector<std::string> scenes{"static-obstacle", "dynamic-obstacle"};
    check_scenes("online", options, scenes);
    for (const std::string& name : scenes) {
        if (!options.wants(name)) continue;
        const Setting s = setting(name, options);
        const std::vector<int> samples =
            s.method.integrator ? std::vector<int>{2, 5, 10} : std::vector<int>{2, 5, 10, 20};
        for (const int count : samples)
            if (!options.small || count <= s.study.samples) json["rows"].push_back(row_of(s, count));
    }
    return json;
}

std::string online_table(const Json& json) {
    std::vector<std::vector<std::string>> lines{{"scene", "p / p_lambda", "gap rows / polynomials", "error in gamma",
                                                 "us, problem", "us, query", "us, checked", "file, MB", "load",
                                                 "same bits", "largest relative error in the norm, %",
                                                 "estimate / error", "below", "bound / error", "us, bound"}};
    for (const Json& row : json["rows"]) lines.push_back(cells(row));
    return table(lines);
}

std::string online_markdown(const Json& json) {
    return "# Online: what a stored model costs to ask, and how far it can be trusted\n\nSize: " +
           json["size"].get<std::string>() + ". CPU time of one thread, medians over " + std::to_string(repeats) +
           " repeats. " + machine_line(json["machine"]) + ".\n\n![effectivities](online.svg)\n\n" +
           online_table(json) +
           "\n- *problem* makes the reduced problem at gamma, its gap included; *query* solves or marches it as "
           "well; "
           "*checked* tells its error on 2p rows of B and 2p of K besides.\n"
           "- *largest relative error in the norm*: |U q - u| / |u|, Euclidean norms of the displacements of all "
           "nodes at one "
           "step, in %, not squared, against the full run on the same grid; the largest over all steps at test "
           "parameters that "
           "neither training nor calibration has seen; the estimate's and the bound's effectivities are least, "
           "median and largest there.\n"
           "- *below* counts tests whose estimate is less than the error. The bound (statics, energy norm) is "
           "proven, "
           "and reads the gap in every row.\n";
}

const Study& online_study() {
    static const Study study =
        study_of_scenes("online", "Stored models: what a query costs, how far it can be trusted", Measured::cpu_time,
                        run_online, online_table, online_markdown);
    return study;
}

}  // namespace tact::bench
