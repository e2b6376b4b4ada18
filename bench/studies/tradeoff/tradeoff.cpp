#include "tradeoff.hpp"

#include <algorithm>
#include <cmath>

#include "../../../contact/automatic.hpp"
#include "../../../contact/dense/dense_contact.hpp"
#include "../../../integrators/central_difference.hpp"
#include "../../../lib/errors.hpp"
#include "../../../rom/bases/compressed_basis.hpp"
#include "../../../rom/greedy/sampling.hpp"
#include "../../harness/measure.hpp"
#include "../../harness/methods.hpp"
#include "../../harness/paper_study.hpp"
#include "../../harness/timing.hpp"

namespace tact::bench {
namespace {

/// A scene over nested grids: (n + 1) / (coarsest + 1) is whole.
struct Ladder {
    std::string scene;
    std::vector<Index> sides;  // of full models, the last the one that reduced models learn from
    Index reference_side;
    std::vector<double> steps;  // dt, the last the training model's; empty in statics
    double reference_step = 0;
    double t_end = 0;
    int output_times = 1;
    std::vector<Index> modes;
    int samples = 1;  // full runs of the training
};

Ladder ladder(const std::string& scene, bool small) {
    if (scene == "static-obstacle")
        return small ? Ladder{scene, {14, 29}, 59, {}, 0, 0, 1, {4, 8}, 16}
                     : Ladder{scene, {24, 49, 99, 199}, 799, {}, 0, 0, 1, {5, 10, 20, 40}, 100};
    if (scene == "dynamic-obstacle")
        return small ? Ladder{scene, {14, 29}, 59, {0.02, 0.01}, 0.0025, 1, 20, {10, 20}, 4}
                     : Ladder{scene, {24, 49, 99, 199},  399, {0.02, 0.01, 0.005}, 0.00125, 2,
                              50,    {20, 40, 100, 150}, 10};
    return small ? Ladder{scene, {14, 29}, 59, {1e-3, 5e-4}, 1.25e-4, 0.1, 20, {10, 20}, 1}
                 : Ladder{scene, {24, 49, 99}, 199, {8e-4, 4e-4, 2e-4}, 1e-4, 0.4, 50, {20, 40, 80, 150}, 1};
}

const std::vector<std::string>& methods_of(const Ladder& wanted) {
    static const std::vector<std::string> none{"none"}, three{"bdf2", "trapezoid", "bdf2-without-jump"};
    return wanted.steps.empty() ? none : three;
}

/// u at the shared nodes, a column an output time.
class Samples {
public:
    Samples(const Ladder& wanted, const Mesh& mesh, double dt) {
        const Index coarse = wanted.sides.front(), ratio = (mesh.n + 1) / (coarse + 1);
        if (ratio * (coarse + 1) != mesh.n + 1) throw InputError("tradeoff: grids are not nested");
        for (const Mesh::Body& body : mesh.bodies)
            for (Index j = 0; j < coarse; ++j)
                for (Index i = 0; i < coarse; ++i)
                    nodes_.push_back(body.first + (i + 1) * ratio - 1 + mesh.n * ((j + 1) * ratio - 1));
        stride_ = dt > 0 ? std::lround(wanted.t_end / wanted.output_times / dt) : 1;
        u_.resize(static_cast<Index>(nodes_.size()), dt > 0 ? wanted.output_times + 1 : 1);
    }
    /// Of the full state, or of U q at the shared nodes.
    Observer observer() {
        return [this](const State& state, const StepReport&) {
            if (state.step % stride_ == 0) u_.col(state.step / stride_) = state.u()(nodes_);
            return Flow::proceed;
        };
    }
    Observer observer(const DenseMatrix& U) {
        const DenseMatrix seen = U(nodes_, Eigen::all);
        return [this, seen](const State& state, const StepReport&) {
            if (state.step % stride_ == 0) u_.col(state.step / stride_) = seen * state.u();
            return Flow::proceed;
        };
    }
    const DenseMatrix& u() const { return u_; }

private:
    std::vector<Index> nodes_;
    long stride_ = 1;
    DenseMatrix u_;
};

Scheme scheme_of(const Ladder& wanted, const std::string& method, double dt) {
    if (wanted.steps.empty()) return {};
    return {integrator(method), TimeGrid::until(wanted.t_end, dt)};
}

double squared_percent(const DenseMatrix& u, const DenseMatrix& reference) {
    return 100 * (u - reference).squaredNorm() / reference.squaredNorm();
}

Parameter asked(const ContactFamily& family) {
    // Neither the middle of the box nor a corner; no sample of a Latin hypercube lands on it.
    return family.names().empty() ? Parameter()
                                  : Parameter(family.lower() + 0.37 * (family.upper() - family.lower()));
}

DenseMatrix full_run(const Ladder& wanted, const std::string& method, Index n, double dt, double* seconds) {
    const StudyScene scene = study_scene(wanted.scene, n);
    const ContactProblem problem = scene.family->at(asked(*scene.family));
    Samples samples(wanted, scene.mesh, dt);
    const std::vector<Observer> record{samples.observer()};
    const double taken = seconds_of([&] {
        ContactWorkspace workspace(std::make_shared<AutomaticContact>());
        (void)run(wanted.scene, problem, scheme_of(wanted, method, dt), workspace, record);
    });
    if (seconds) *seconds = taken;
    return samples.u();
}

Json row_of(const Ladder& wanted, const char* model, const std::string& method, Index n, double dt, double error) {
    return {{"scene", wanted.scene},
            {"model", model},
            {"integrator", method},
            {"n", n},
            {"dt", dt > 0 ? Json(dt) : Json()},
            {"error_percent", error},
            {"error_norm_percent", 10 * std::sqrt(error)}};
}

const std::string explicit_method = "central-difference";

/// The ladder's steps; of the explicit method the largest that is stable on this grid and meets the output times: what is
/// left of the error then is the grid's.
std::vector<double> steps_of(const Ladder& wanted, const std::string& method, Index n) {
    if (wanted.steps.empty()) return {0};
    if (method != explicit_method) return wanted.steps;
    const StudyScene scene = study_scene(wanted.scene, n);
    const ContactProblem problem = scene.family->at(asked(*scene.family));
    ContactWorkspace workspace(std::make_shared<AutomaticContact>());
    const double between = wanted.t_end / wanted.output_times;
    return {between / std::ceil(between / CentralDifference::largest_step(problem, workspace))};
}

void add_full(Json& rows, const Ladder& wanted, const DenseMatrix& reference) {
    std::vector<std::string> methods = methods_of(wanted);
    if (!wanted.steps.empty()) methods.push_back(explicit_method);
    Progress progress("tradeoff: " + wanted.scene + ": full models",
                      static_cast<double>(methods.size() * wanted.sides.size()));
    for (const std::string& method : methods)
        for (const Index n : wanted.sides) {
            for (const double dt : steps_of(wanted, method, n)) {
                double seconds = 0;
                const double error = squared_percent(full_run(wanted, method, n, dt, &seconds), reference);
                Json row = row_of(wanted, "full", method, n, dt, error);
                row["seconds"] = seconds;
                row["training_model"] =
                    n == wanted.sides.back() && (wanted.steps.empty() || dt == wanted.steps.back());
                rows.push_back(row);
            }
            progress.add(1);
        }
}

struct Recipe {
    const char* name;
    DualBasis basis;
    double dual_share, compliance;
};

void add_reduced(Json& rows, const Ladder& wanted, const DenseMatrix& reference) {
    const double dt = wanted.steps.empty() ? 0 : wanted.steps.back();
    const StudyScene scene = study_scene(wanted.scene, wanted.sides.back());
    const ContactFamily& family = *scene.family;
    std::vector<Parameter> samples{Parameter()};
    if (!family.names().empty()) samples = latin_hypercube(family.lower(), family.upper(), wanted.samples, 1);
    const std::vector<Recipe> recipes{
        {"NNMF", nnmf_basis(), 1, 0},
        {"selected rows", selected_rows(), wanted.steps.empty() ? 1 : 0.5, wanted.steps.empty() ? 0 : 0.3}};
    Progress progress(
        "tradeoff: " + wanted.scene + ": reduced models",
        static_cast<double>(methods_of(wanted).size() * (samples.size() + recipes.size() * wanted.modes.size())));
    for (const std::string& method : methods_of(wanted)) {
        const Scheme scheme = scheme_of(wanted, method, dt);
        PodAccumulator primal({.max_vectors = 2 * wanted.modes.back()});
        DualSnapshots dual(family.at(samples.front()).constraints());
        SnapshotRecorder recorder(family.at(samples.front()).size(), scheme.steps(), {}, dual,
                                  [&](const Eigen::Ref<const DenseMatrix>& block) { primal.add(block); });
        const double full_seconds = seconds_of([&] {
            ContactWorkspace workspace(std::make_shared<AutomaticContact>());
            for (const Parameter& gamma : samples) {
                const std::vector<Observer> record{recorder.observer()};
                (void)run(wanted.scene, family.at(gamma), scheme, workspace, record);
                recorder.flush();
                progress.add(1);
            }
        });
        for (const Recipe& recipe : recipes)
            for (const Index p : wanted.modes) {
                BasisRecipe sizes;
                sizes.sizes = {std::min(p, primal.vectors()),
                               std::lround(recipe.dual_share * static_cast<double>(p))};
                sizes.dual_basis = recipe.basis;
                ReducedBasis basis;
                std::unique_ptr<ContactFamily> reduced;
                const double built = seconds_of([&] {
                    basis = compressed_basis(family.at(samples.front()), primal, dual, sizes).basis;
                    reduced = reduce(scene.family, basis);
                });
                ContactWorkspace workspace(
                    std::make_shared<DenseContact>(DenseContactOptions{.compliance = recipe.compliance}));
                Samples seen(wanted, scene.mesh, dt);
                const std::vector<Observer> record{seen.observer(basis.U)};
                const auto query = [&](std::span<const Observer> observers) {
                    (void)run(wanted.scene + ", reduced", reduced->at(asked(family)), scheme, workspace, observers);
                };
                query(record);
                const int loops = scheme.integrator ? 3 : 300;
                const double seconds = median_seconds(5, [&] {
                    for (int k = 0; k < loops; ++k) query({});
                });
                Json row =
                    row_of(wanted, "reduced", method, wanted.sides.back(), dt, squared_percent(seen.u(), reference));
                row["p"] = basis.primal_size();
                row["p_lambda"] = basis.dual_size();
                row["dual_basis"] = recipe.name;
                row["seconds"] = seconds / loops;
                row["training_seconds"] = full_seconds + built;
                rows.push_back(row);
                progress.add(1);
            }
    }
}

/// For the reduced models no other of their scene and integrator is better than in both error and time.
Json break_even(const Json& rows, const std::string& scene) {
    Json result = Json::array();
    for (const Json& row : rows) {
        if (row["scene"] != scene || row["model"] != "reduced") continue;
        const auto better = [&](const Json& other) {
            return other["scene"] == scene && other["model"] == "reduced" &&
                   other["integrator"] == row["integrator"] && other["error_percent"] < row["error_percent"] &&
                   other["seconds"] <= row["seconds"];
        };
        if (std::ranges::any_of(rows, better)) continue;
        const Json* cheapest = nullptr;
        for (const Json& full : rows)
            if (full["scene"] == scene && full["model"] == "full" && full["error_percent"] <= row["error_percent"] &&
                (!cheapest || full["seconds"] < (*cheapest)["seconds"]))
                cheapest = &full;
        Json entry{{"scene", scene},
                   {"integrator", row["integrator"]},
                   {"dual_basis", row["dual_basis"]},
                   {"p", row["p"]},
                   {"error_percent", row["error_percent"]}};
        entry["full"] = entry["queries"] = nullptr;
        if (cheapest) {
            entry["full"] = {{"integrator", (*cheapest)["integrator"]},
                             {"n", (*cheapest)["n"]},
                             {"dt", (*cheapest)["dt"]},
                             {"seconds", (*cheapest)["seconds"]}};
            const double saved = (*cheapest)["seconds"].get<double>() - row["seconds"].get<double>();
            if (saved > 0) entry["queries"] = std::ceil(row["training_seconds"].get<double>() / saved);
        }
        result.push_back(entry);
    }
    return result;
}

/// The rows as they are with the paper's scheme: the reduced model with most selected rows and the full one it learnt from;
/// and the cheapest full model of any integrator on a coarser grid whose error is no larger than the reduced one's.
Json rival(const Json& rows, const std::string& scene, const std::string& scheme) {
    Json reduced, training_model, full;
    for (const Json& row : rows) {
        if (row["scene"] != scene || row["integrator"] != scheme) continue;
        if (row["model"] == "reduced" && row["dual_basis"] == "selected rows" &&
            (reduced.is_null() || row["p"] > reduced["p"]))
            reduced = row;
        if (row.value("training_model", false)) training_model = row;
    }
    for (const Json& row : rows)
        if (row["scene"] == scene && row["model"] == "full" && row["n"] < training_model["n"] &&
            row["error_percent"] <= reduced["error_percent"] && (full.is_null() || row["seconds"] < full["seconds"]))
            full = row;
    return {{"scene", scene}, {"reduced", reduced}, {"training_model", training_model}, {"full", full}};
}

}  // namespace

Json run_tradeoff(const StudyOptions& options) {
    check_scenes("tradeoff", options, paper_study_names());
    Json json{{"study", "tradeoff"}, {"size", options.small ? "small" : "full"}, {"machine", machine()}};
    json["references"] = json["rows"] = json["break_even"] = json["rivals"] = Json::array();
    for (const std::string& scene : paper_study_names()) {
        if (!options.wants(scene)) continue;
        const Ladder wanted = ladder(scene, options.small);
        const std::string method = wanted.steps.empty() ? "none" : "trapezoid";
        DenseMatrix reference, half;
        {
            Progress progress("tradeoff: " + scene + ": reference", 2);
            half = full_run(wanted, method, (wanted.reference_side - 1) / 2, 2 * wanted.reference_step, nullptr);
            progress.add(1);
            reference = full_run(wanted, method, wanted.reference_side, wanted.reference_step, nullptr);
        }
        const Parameter gamma = asked(*study_scene(scene, wanted.sides.front()).family);
        json["references"].push_back({{"scene", scene},
                                      {"parameter", std::vector<double>(gamma.begin(), gamma.end())},
                                      {"integrator", method},
                                      {"n", wanted.reference_side},
                                      {"dt", wanted.steps.empty() ? Json() : Json(wanted.reference_step)},
                                      {"own_error_percent", squared_percent(half, reference)}});
        add_full(json["rows"], wanted, reference);
        add_reduced(json["rows"], wanted, reference);
        for (const Json& entry : break_even(json["rows"], scene)) json["break_even"].push_back(entry);
        json["rivals"].push_back(rival(json["rows"], scene, methods_of(wanted).front()));
    }
    return json;
}

}  // namespace tact::bench
