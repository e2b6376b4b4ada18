#include "bases.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <utility>

#include "../../../contact/automatic.hpp"
#include "../../../contact/dense/dense_contact.hpp"
#include "../../../lib/sparse/cholmod_solver.hpp"
#include "../../../rom/bases/compressed_basis.hpp"
#include "../../../rom/greedy/training_error.hpp"
#include "../../harness/basis_recipes.hpp"
#include "../../harness/interrupt.hpp"
#include "../../harness/methods.hpp"
#include "../../harness/paper_study.hpp"
#include "../../harness/reference_runs.hpp"
#include "../../harness/timing.hpp"

namespace tact::bench {
namespace {

constexpr Index all_rows = 1'000'000;  // more than there are: a recipe gives what it has

/// What full runs left.
struct Snapshots {
    PodAccumulator primal;
    DualSnapshots dual;
    double seconds = 0;
};

Snapshots collect(const PaperStudy& study, const Scheme& scheme, const std::vector<Parameter>& samples,
                  Index largest_p) {
    const ContactFamily& family = *study.scene.family;
    const ContactProblem first = family.at(samples.front());
    Snapshots kept{PodAccumulator({.max_vectors = 2 * largest_p}), DualSnapshots(first.constraints())};
    SnapshotRecorder recorder(first.size(), scheme.steps(), {}, kept.dual,
                              [&](const Eigen::Ref<const DenseMatrix>& block) { kept.primal.add(block); });
    ContactWorkspace workspace(std::make_shared<AutomaticContact>());
    Progress progress(study.scene.name + ": full runs of the training", static_cast<double>(samples.size()));
    kept.seconds = seconds_of([&] {
        for (const Parameter& gamma : samples) {
            const std::vector<Observer> record{recorder.observer()};
            (void)run(study.scene.name, family.at(gamma), scheme, workspace, record);
            recorder.flush();
            progress.add(1);
        }
    });
    return kept;
}

/// One integrator of a scene with its snapshots and references.
struct Setting {
    const PaperStudy& study;
    std::string integrator, training;
    Scheme scheme;
    std::vector<Parameter> samples;
    Snapshots snapshots;
    const ReferenceRuns& references;
};

/// A member: one seed at one p.
struct Member {
    double error = 0, median = 0, penetration = 0, us_per_step = 0, training_seconds = 0, kkt = 0;
    Index p = 0, p_lambda = 0;
    Outcome outcome = Outcome::converged;
};

double online_seconds(const Setting& setting, const ReducedBasis& basis, const ContactFamily& reduced,
                      ContactWorkspace& workspace, int repeats) {
    const std::vector<Parameter>& tests = setting.references.parameters();
    std::vector<Parameter> asked;
    for (const long k : spread(5, static_cast<long>(tests.size())))
        asked.push_back(tests[static_cast<std::size_t>(k)]);
    const auto all = [&] {
        for (const Parameter& gamma : asked)
            (void)run(setting.study.scene.name + ", reduced", reduced.at(gamma), setting.scheme, workspace, {},
                      march_options(basis));
    };
    const int loops = std::max(1, static_cast<int>(0.005 / std::max(seconds_of(all), 1e-6)));
    const double seconds = median_seconds(repeats, [&] {
        for (int k = 0; k < loops; ++k) all();
    });
    return seconds / (loops * static_cast<double>(asked.size()) * static_cast<double>(setting.scheme.steps()));
}

/// Static modes at the rows that contact would be selected at, `count` in all with the load's, and the fewer modes beside them.
void hold_static_modes(const Setting& setting, const ContactProblem& problem, Index count, BasisRecipe& recipe) {
    if (count < 2) return;
    BasisRecipe choice;
    choice.sizes = {recipe.sizes.p, count - 1};
    choice.dual_basis = selected_rows();
    const DenseMatrix chosen =
        compressed_basis(problem, setting.snapshots.primal, setting.snapshots.dual, choice).basis.U_lambda;
    std::vector<Index> rows(static_cast<std::size_t>(chosen.cols()));
    for (Index j = 0; j < chosen.cols(); ++j) chosen.col(j).maxCoeff(&rows[static_cast<std::size_t>(j)]);
    recipe.primal.held = static_modes(problem, rows, CholmodSolver());
    recipe.sizes.p -= recipe.primal.held.cols();
}

/// Both bases of a member, and the family in them.
struct Made {
    ReducedBasis basis;
    std::unique_ptr<ContactFamily> reduced;
    double seconds = 0;
};

std::shared_ptr<const DenseContact> contact_of(const BasisStudyRecipe& recipe) {
    return std::make_shared<DenseContact>(DenseContactOptions{.compliance = recipe.compliance});
}

Made make(const Setting& setting, const BasisStudyRecipe& recipe, const DualBasis& dual, Index p) {
    const ContactFamily& family = *setting.study.scene.family;
    const Scheme& scheme = setting.scheme;
    BasisRecipe wanted;
    wanted.dual_basis = dual;
    wanted.sizes.p = std::min(p, setting.snapshots.primal.vectors());
    wanted.sizes.p_lambda = recipe.dual_share ? std::lround(*recipe.dual_share * static_cast<double>(p)) : all_rows;
    wanted.supremizers.share = recipe.supremizers;
    wanted.supremizers.linear = std::make_shared<CholmodSolver>();
    wanted.supremizers.a = scheme.integrator ? 1.5 / scheme.grid.dt : 0;
    TrainingError training_error(setting.study.scene.family, {scheme.integrator, scheme.grid},
                                 {std::make_shared<AutomaticContact>(), contact_of(recipe)}, setting.samples);
    if (recipe.swaps > 0)
        wanted.dual_basis = selected_rows({.tries = recipe.swaps, .error = std::ref(training_error)});

    Made made;
    made.seconds = seconds_of([&] {
        const ContactProblem problem = family.at(setting.samples.front());
        if (recipe.bodies) wanted.primal.body_of = connected_bodies(problem.K);
        hold_static_modes(setting, problem, std::lround(recipe.static_modes * static_cast<double>(p)), wanted);
        made.basis = compressed_basis(problem, setting.snapshots.primal, setting.snapshots.dual, wanted).basis;
        made.reduced = reduce(setting.study.scene.family, made.basis);
    });
    return made;
}

Member measure(const Setting& setting, const BasisStudyRecipe& recipe, const Made& made, int repeats) {
    const auto dense = contact_of(recipe);
    Member member;
    member.training_seconds = made.seconds;
    member.p = made.basis.primal_size();
    member.p_lambda = made.basis.dual_size();
    const ReducedErrors errors = setting.references.errors(made.basis, *made.reduced, dense);
    member.outcome = errors.outcome;
    if (errors.outcome != Outcome::converged) return member;
    member.error = errors.worst();
    member.median = errors.median();
    member.penetration = errors.penetration;
    member.kkt = errors.worst_kkt;
    ContactWorkspace workspace(dense);
    member.us_per_step = 1e6 * online_seconds(setting, made.basis, *made.reduced, workspace, repeats);
    return member;
}

Json row_of(const Setting& setting, const BasisStudyRecipe& recipe, const std::vector<Index>& sizes,
            const std::vector<Member>& members) {
    Outcome outcome = Outcome::converged;
    for (const Member& member : members)
        if (member.outcome != Outcome::converged) outcome = member.outcome;
    const Member& middle = members[members.size() / 2];
    Json row{{"scene", setting.study.scene.name},
             {"integrator", setting.integrator},
             {"training", setting.training},
             {"dual_basis", recipe.name},
             {"p", sizes[sizes.size() / 2]},
             {"p_lambda", middle.p_lambda},
             {"supremizer_share", recipe.supremizers},
             {"compliance", recipe.compliance},
             {"members", members.size()},
             {"outcome", to_string(outcome)},
             {"pareto", false}};
    const bool failed = outcome != Outcome::converged;
    const auto put = [&](const char* field, double value) { row[field] = failed ? Json() : Json(value); };
    const auto collect = [&](double Member::*field) {
        std::vector<double> values;
        for (const Member& member : members) values.push_back(member.*field);
        return values;
    };
    const std::vector<double> errors = collect(&Member::error);
    double logarithms = 0;
    for (const double error : errors) logarithms += std::log(error);
    put("error_percent", std::exp(logarithms / static_cast<double>(errors.size())));
    put("error_min", *std::ranges::min_element(errors));
    put("error_max", *std::ranges::max_element(errors));
    put("error_median", median(collect(&Member::median)));
    const std::vector<double> penetrations = collect(&Member::penetration), residuals = collect(&Member::kkt);
    put("penetration", *std::ranges::max_element(penetrations));
    put("us_per_step", median(collect(&Member::us_per_step)));
    put("training_seconds", median(collect(&Member::training_seconds)));
    put("kkt_residual", *std::ranges::max_element(residuals));
    return row;
}

using Recipes = std::vector<const BasisStudyRecipe*>;

/// The members of recipes that make the same bases, [recipe][member].
std::vector<std::vector<Member>> measure_all(const Setting& setting, const Recipes& recipes,
                                             const std::vector<Index>& sizes, int repeats) {
    std::vector<std::vector<Member>> members(recipes.size());
    for (const Index p : sizes)
        for (const DualBasis& dual : recipes.front()->members) {
            throw_if_interrupted();
            const Made made = make(setting, *recipes.front(), dual, p);
            for (std::size_t k = 0; k < recipes.size(); ++k)
                members[k].push_back(measure(setting, *recipes[k], made, repeats));
        }
    return members;
}

/// By recipe, then by size, of which all have the paper's.
Json rows_of(const Setting& setting, const Recipes& recipes, const std::vector<std::vector<Index>>& sizes,
             int repeats) {
    const std::size_t paper_size = std::min<std::size_t>(1, sizes.size() - 1);
    std::map<std::pair<std::size_t, std::size_t>, Json> rows;
    Progress progress(setting.study.scene.name + ", " + setting.integrator + ": bases",
                      static_cast<double>(recipes.size() * sizes.size()));
    for (std::size_t first = 0; first < recipes.size(); ++first)
        for (std::size_t k = 0; k < sizes.size(); ++k, progress.add(1)) {
            if (rows.contains({first, k})) continue;
            std::vector<std::size_t> places;
            Recipes alike;
            for (std::size_t r = first; r < recipes.size(); ++r)
                if (recipes[r]->same_bases(*recipes[first]) && (recipes[r]->every_size || k == paper_size)) {
                    places.push_back(r);
                    alike.push_back(recipes[r]);
                }
            if (alike.empty()) continue;
            const auto members = measure_all(setting, alike, sizes[k], repeats);
            for (std::size_t i = 0; i < alike.size(); ++i)
                rows[{places[i], k}] = row_of(setting, *alike[i], sizes[k], members[i]);
        }
    Json list = Json::array();
    for (auto& [place, row] : rows) list.push_back(std::move(row));
    return list;
}

void mark_pareto(Json& rows) {
    for (Json& row : rows) {
        if (row["error_percent"].is_null()) continue;
        row["pareto"] = std::ranges::none_of(rows, [&](const Json& other) {
            return other["scene"] == row["scene"] && other["integrator"] == row["integrator"] &&
                   other["error_percent"].is_number() && other["us_per_step"] < row["us_per_step"] &&
                   other["error_percent"] < row["error_percent"];
        });
    }
}

/// Sizes p, each with its neighbours; the paper's is the second.
std::vector<std::vector<Index>> sizes_of(const std::string& scene, bool small) {
    std::vector<Index> middles{40, 100, 150, 200};
    Index step = 2, neighbours = 1;
    if (scene == "static-obstacle") {
        middles = small ? std::vector<Index>{5} : std::vector<Index>{10, 20};
        step = 1;
    } else if (scene == "two-plates") {
        middles = small ? std::vector<Index>{12} : std::vector<Index>{20, 40, 80, 150};
        step = 1;
        neighbours = small ? 1 : 2;
    } else if (small) {
        middles = {16};
    }
    if (small) neighbours = 0;
    std::vector<std::vector<Index>> sizes;
    for (const Index middle : middles) {
        sizes.emplace_back();
        for (Index k = -neighbours; k <= neighbours; ++k) sizes.back().push_back(middle + step * k);
    }
    return sizes;
}

bool fits(const BasisStudyRecipe& recipe, const PaperStudy& study, const std::string& integrator) {
    if (recipe.bodies && study.scene.name != "two-plates") return false;
    if (study.scene.is_static()) return recipe.compliance == 0;
    if (recipe.name == "all snapshots") return false;  // thousands
    // The laws of impact are compared on what the diagram of the first has left.
    return integrator == "bdf2" || recipe.name == "NNMF" || recipe.name.starts_with("selected rows");
}

struct TrainingSet {
    std::string name;
    std::vector<Parameter> samples;
};

std::vector<TrainingSet> training_sets(const PaperStudy& study) {
    if (study.scene.family->names().empty()) return {{"the run itself", {Parameter()}}};
    std::vector<TrainingSet> sets;
    const Scheme scheme = paper_scheme(study.scene);
    const auto greedy = [&](GridKind kind) {
        TrainingOptions options = paper_training(study);
        options.candidates = training_candidates(study, kind);
        return samples_of(train_with_progress(study, {scheme.integrator, scheme.grid}, options));
    };
    sets.push_back({"greedy, cell-centred candidates", greedy(GridKind::cell_centred)});
    if (!study.scene.is_static()) return sets;
    sets.push_back({"greedy, closed candidates", greedy(GridKind::closed)});
    sets.push_back({"all cell-centred candidates", training_candidates(study, GridKind::cell_centred)});
    sets.push_back({"all closed candidates", training_candidates(study, GridKind::closed)});
    return sets;
}

}  // namespace

Json run_bases(const BasesOptions& options) {
    if (options.repeats < 1)
        throw InputError("bases: repeats is " + std::to_string(options.repeats) + ", expected at least 1");
    for (const std::string& name : options.recipes)
        if (const auto names = basis_recipe_names(); std::ranges::find(names, name) == names.end())
            throw InputError("bases: recipe is " + name + ", expected one of those `tact-bench bases --help` lists");
    Json json{{"study", "bases"}, {"size", options.small ? "small" : "full"}, {"repeats", options.repeats}};
    json["machine"] = machine();
    json["trainings"] = Json::array();
    json["rows"] = Json::array();
    for (const std::string& name : wanted_scenes("bases", options.scenes)) {
        const PaperStudy study = paper_study(name, options.small);
        const std::vector<std::vector<Index>> sizes = sizes_of(name, options.small);
        const std::vector<TrainingSet> sets = training_sets(study);
        std::vector<std::string> integrators{"bdf2", "trapezoid", "bdf2-without-jump"};
        if (!options.integrators.empty()) integrators = options.integrators;
        if (study.scene.is_static()) integrators = {"none"};
        for (const std::string& method : integrators) {
            Scheme scheme = paper_scheme(study.scene);
            if (scheme.integrator) scheme.integrator = integrator(method);
            std::vector<Parameter> seen;
            for (const TrainingSet& set : sets) seen.insert(seen.end(), set.samples.begin(), set.samples.end());
            const ReferenceRuns references(study.scene, scheme, without(study.tests, seen));
            for (const TrainingSet& set : sets) {
                const Setting setting{study,       method,
                                      set.name,    scheme,
                                      set.samples, collect(study, scheme, set.samples, sizes.back().back()),
                                      references};
                json["trainings"].push_back({{"scene", name},
                                             {"integrator", method},
                                             {"training", set.name},
                                             {"samples", set.samples.size()},
                                             {"snapshots", setting.snapshots.primal.snapshots()},
                                             {"contact_snapshots", setting.snapshots.dual.size()},
                                             {"test_parameters", references.parameters().size()},
                                             {"seconds_full", setting.snapshots.seconds}});
                Recipes chosen;
                for (const BasisStudyRecipe& recipe : basis_recipes())
                    if (fits(recipe, study, method) &&
                        (options.recipes.empty()
                             ? !recipe.only_if_named()
                             : std::ranges::find(options.recipes, recipe.name) != options.recipes.end()))
                        chosen.push_back(&recipe);
                for (Json& row : rows_of(setting, chosen, sizes, options.repeats))
                    json["rows"].push_back(std::move(row));
            }
        }
    }
    mark_pareto(json["rows"]);
    return json;
}

}  // namespace tact::bench
