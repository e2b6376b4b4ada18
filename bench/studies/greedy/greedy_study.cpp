#include "greedy_study.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "../../harness/basis_errors.hpp"
#include "../../harness/interrupt.hpp"
#include "../../harness/paper_study.hpp"
#include "../../harness/timing.hpp"

namespace tact::bench {
namespace {

struct Selection {
    std::string name;
    IndicatorWeights weights;
};

const std::string true_error = "true error", random_samples = "Latin hypercube", paper_weights = "(1,0,0)",
                  closed_grid = "(1,0,0), closed grid";

/// Every set of weights 0 or 1.
std::vector<Selection> indicators() {
    return {{paper_weights, {1, 0, 0}}, {"(0,1,0)", {0, 1, 0}}, {"(0,0,1)", {0, 0, 1}}, {"(1,1,0)", {1, 1, 0}},
            {"(1,0,1)", {1, 0, 1}},     {"(0,1,1)", {0, 1, 1}}, {"(1,1,1)", {1, 1, 1}}};
}

Json row_of(const PaperStudy& study, const std::string& selection, const TestedBasis& basis,
            const std::vector<double>& percents) {
    const double worst = *std::ranges::max_element(percents);
    return {{"scene", study.scene.name},
            {"selection", selection},
            {"p", basis.U.cols()},
            {"p_lambda", basis.reduced->at(study.tests.front()).constraints()},
            {"test_parameters", percents.size()},
            {"worst_error_percent", worst},
            {"median_error_percent", median(percents)},
            {"worst_error_norm", std::sqrt(worst / 100)}};
}

void add_iteration(Json& row, const TrainingIteration& iteration, std::size_t number) {
    row["iteration"] = number;
    row["sampled"] = std::vector<double>(iteration.gamma.begin(), iteration.gamma.end());
}

/// The true error at a candidate, from full states at the steps of J in single precision: it only has to choose.
class Oracle {
public:
    Oracle(const PaperStudy& study, const Scheme& scheme, const TrainingOptions& training) {
        ContactWorkspace workspace(study_contact().full);
        Progress progress(study.scene.name + ": full runs at the candidates",
                          static_cast<double>(training.candidates.size()));
        for (const Parameter& gamma : training.candidates) {
            const FullStates full = full_states(study.scene, scheme, {gamma}, workspace);
            const long stride = scheme.integrator ? training.indicator_stride : 1;
            const Index first = scheme.integrator ? stride : 0, count = (full.u.cols() - 1 - first) / stride + 1;
            Eigen::MatrixXf& kept = states_[key(gamma)];
            kept.resize(full.u.rows(), count);
            for (Index j = 0; j < count; ++j) kept.col(j) = full.u.col(first + j * stride).cast<float>();
            progress.add(1);
        }
    }
    double operator()(const Parameter& gamma, const ReducedBasis& basis, const ReducedStates& reduced) const {
        return squared_distances(basis.U, reduced.q.leftCols(reduced.size()), states_.at(key(gamma)).cast<double>())
            .sum();
    }

private:
    static std::vector<double> key(const Parameter& gamma) { return {gamma.begin(), gamma.end()}; }
    std::map<std::vector<double>, Eigen::MatrixXf> states_;
};

/// Trains by every indicator and by the true error; `tell` is given each basis on the way.
void train_all(const PaperStudy& study, const Scheme& scheme,
               const std::function<void(const std::string& selection, const TrainingResult&)>& tell) {
    TrainingOptions training = paper_training(study);
    std::vector<Selection> selections = indicators();
    selections.push_back({true_error, {}});
    for (const Selection& selection : selections) {
        training.weights = selection.weights;
        if (selection.name == true_error)
            training.oracle = [oracle = std::make_shared<Oracle>(study, scheme, training)](
                                  const Parameter& gamma, const ReducedBasis& basis, const ReducedStates& states) {
                return (*oracle)(gamma, basis, states);
            };
        training.on_basis = [&](const TrainingResult& so_far) { tell(selection.name, so_far); };
        (void)train_with_progress(study, {scheme.integrator, scheme.grid}, training, "training by " + selection.name);
    }
}

/// The snapshots of random samples, uncompressed as those of the greedy search in statics.
TestedBasis random_basis(const PaperStudy& study, Index samples, std::uint32_t seed, ContactWorkspace& workspace) {
    const ContactFamily& family = *study.scene.family;
    ReducedBasis basis;
    std::vector<Vector> multipliers;
    for (const Parameter& gamma : latin_hypercube(family.lower(), family.upper(), samples, seed)) {
        throw_if_interrupted();
        const StaticSolution solution = solve_static(family.at(gamma), workspace);
        if (solution.report.outcome != Outcome::converged)
            throw NumericalError(study.scene.name + ": the contact solve ended with " +
                                 std::string(to_string(solution.report.outcome)));
        basis.U.conservativeResize(solution.u.size(), basis.U.cols() + 1);
        basis.U.rightCols(1) = solution.u;
        if (solution.lambda.maxCoeff() > 0) multipliers.push_back(solution.lambda.cwiseMax(0).normalized());
    }
    basis.U_lambda.resize(basis.U.rows(), static_cast<Index>(multipliers.size()));
    for (std::size_t j = 0; j < multipliers.size(); ++j) basis.U_lambda.col(static_cast<Index>(j)) = multipliers[j];
    basis = modal_basis(family.at(family.lower()), basis);
    return {basis.U, reduce(study.scene.family, basis)};
}

/// The same search when the box's faces are among the candidates: it then need not extrapolate to them.
void add_closed_grid(const PaperStudy& study, const Scheme& scheme, const FullStates& tests, Json& rows) {
    TrainingOptions training = paper_training(study);
    training.candidates = training_candidates(study, GridKind::closed);
    training.on_basis = [&](const TrainingResult& result) {
        const TestedBasis basis{result.basis.U, result.reduced};
        const std::vector<double> percents = squared_percents(basis, scheme, tests);
        std::vector<double> others;  // at parameters that are no candidates
        for (std::size_t k = 0; k < percents.size(); ++k)
            if (!without({tests.gammas[k]}, training.candidates).empty()) others.push_back(percents[k]);
        rows.push_back(row_of(study, closed_grid, basis, others));
        add_iteration(rows.back(), result.history.back(), result.history.size());
    };
    (void)train_with_progress(study, {scheme.integrator, scheme.grid}, training, "training on the closed grid");
}

Json static_rows(bool small) {
    const PaperStudy study = paper_study("static-obstacle", small);
    const Scheme scheme = paper_scheme(study.scene);
    ContactWorkspace workspace(study_contact().full);
    const FullStates tests = full_states(study.scene, scheme, study.tests, workspace);
    Json rows = Json::array();
    train_all(study, scheme, [&](const std::string& selection, const TrainingResult& result) {
        const TestedBasis basis{result.basis.U, result.reduced};
        rows.push_back(row_of(study, selection, basis, squared_percents(basis, scheme, tests)));
        add_iteration(rows.back(), result.history.back(), result.history.size());
    });
    add_closed_grid(study, scheme, tests, rows);
    const int repeats = small ? 10 : 50;
    Progress progress(study.scene.name + ": random samples", 2 * repeats);
    for (const int divisor : {2, 1})
        for (int repeat = 1; repeat <= repeats; ++repeat) {
            const Index samples = study.samples / divisor;
            const TestedBasis basis = random_basis(study, samples, static_cast<std::uint32_t>(repeat), workspace);
            rows.push_back(row_of(study, random_samples, basis, squared_percents(basis, scheme, tests)));
            rows.back()["samples"] = samples;
            rows.back()["repeat"] = repeat;
            progress.add(1);
        }
    return rows;
}

Json dynamic_rows(bool small) {
    const PaperStudy study = paper_study("dynamic-obstacle", small);
    const Scheme scheme = paper_scheme(study.scene);
    struct Trained {
        std::string selection;
        std::size_t number;
        TrainingIteration iteration;
        TestedBasis basis;
        std::vector<double> percents;
    };
    std::vector<Trained> all;
    train_all(study, scheme, [&](const std::string& selection, const TrainingResult& result) {
        all.push_back(
            {selection, result.history.size(), result.history.back(), {result.basis.U, result.reduced}, {}});
    });
    // Parameter by parameter, because all full states at once would fill the memory.
    ContactWorkspace workspace(study_contact().full);
    Progress progress(study.scene.name + ": errors", static_cast<double>(study.tests.size() * all.size()));
    for (const Parameter& gamma : study.tests) {
        const FullStates full = full_states(study.scene, scheme, {gamma}, workspace);
        for (Trained& trained : all) {
            trained.percents.push_back(squared_percents(trained.basis, scheme, full).front());
            progress.add(1);
        }
    }
    Json rows = Json::array();
    for (const Trained& trained : all) {
        rows.push_back(row_of(study, trained.selection, trained.basis, trained.percents));
        add_iteration(rows.back(), trained.iteration, trained.number);
    }
    return rows;
}

/// The worst errors of one selection in the order of its iterations, or of the random repeats with so many samples.
std::vector<double> worst(const Json& rows, const std::string& scene, const std::string& selection, int samples = 0) {
    std::vector<double> values;
    for (const Json& row : rows)
        if (row["scene"] == scene && row["selection"] == selection && (samples == 0 || row["samples"] == samples))
            values.push_back(row["worst_error_percent"].get<double>());
    return values;
}

void claim(Json& claims, const std::string& scene, const std::string& text, const std::string& paper, double figure,
           bool holds) {
    claims.push_back({{"scene", scene}, {"claim", text}, {"paper", paper}, {"figure", figure}, {"holds", holds}});
}

/// The smallest and the largest of the last worst errors over all weights.
std::pair<double, double> ends(const Json& rows, const std::string& scene) {
    double best = infinity, poorest = 0;
    for (const Selection& selection : indicators()) {
        const double end = worst(rows, scene, selection.name).back();
        best = std::min(best, end);
        poorest = std::max(poorest, end);
    }
    return {best, poorest};
}

void static_claims(const Json& rows, Json& claims) {
    const std::string scene = "static-obstacle";
    const std::vector<double> greedy = worst(rows, scene, paper_weights);
    const int samples = static_cast<int>(greedy.size());
    const double random = median(worst(rows, scene, random_samples, samples));
    const double half = greedy[greedy.size() / 2 - 1], last = greedy.back(), best = ends(rows, scene).first;
    claim(claims, scene,
          "the greedy search with " + std::to_string(samples / 2) + " samples is as accurate as " +
              std::to_string(samples) + " random ones (median): ratio of worst errors, squared as printed",
          "about 1", half / random, half <= 1.1 * random);
    claim(claims, scene,
          "with " + std::to_string(samples) +
              " it is an order of magnitude more accurate than as many random ones: ratio, squared as printed",
          "about 10", random / last, random >= 10 * last);
    claim(claims, scene,
          "the same with candidates on the faces of the box too (closed grid): ratio, squared as printed", "about 10",
          random / worst(rows, scene, closed_grid).back(), random >= 10 * worst(rows, scene, closed_grid).back());
    claim(claims, scene,
          "weights (1,0,0) do as well as any: last worst error over the best of all weights, squared as printed",
          "about 1", last / best, last <= 1.1 * best);
}

void dynamic_claims(const Json& rows, Json& claims) {
    const std::string scene = "dynamic-obstacle";
    const auto [best, poorest] = ends(rows, scene);
    claim(claims, scene,
          "all weights do equally well: poorest last worst error over the best, squared as printed (equal: within 2)",
          "about 1", poorest / best, poorest <= 2 * best);
    double least = infinity;
    for (const Selection& selection : indicators()) {
        const std::vector<double> errors = worst(rows, scene, selection.name);
        least = std::min(least, errors.front() / errors.back());
    }
    claim(claims, scene,
          "the worst error falls by more than 100 from the first iteration to the last: least factor of all weights, "
          "squared as printed",
          "over 100", least, least > 100);
}

}  // namespace

Json run_greedy(const StudyOptions& options) {
    check_scenes("greedy", options, {"static-obstacle", "dynamic-obstacle"});
    Json json;
    json["study"] = "greedy";
    json["size"] = options.small ? "small" : "full";
    json["machine"] = machine();
    json["rows"] = json["claims"] = Json::array();
    if (options.wants("static-obstacle")) {
        json["rows"] = static_rows(options.small);
        static_claims(json["rows"], json["claims"]);
    }
    if (options.wants("dynamic-obstacle")) {
        for (Json& row : dynamic_rows(options.small)) json["rows"].push_back(std::move(row));
        dynamic_claims(json["rows"], json["claims"]);
    }
    return json;
}

}  // namespace tact::bench
