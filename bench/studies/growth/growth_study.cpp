#include "growth_study.hpp"

#include <chrono>

#include "../../../contact/automatic.hpp"
#include "../../../contact/dense/dense_contact.hpp"
#include "../../../integrators/sundials/bdf2.hpp"
#include "../../../lib/errors.hpp"
#include "../../../lib/scenes/membrane.hpp"
#include "../../../rom/bases/compressed_basis.hpp"
#include "../../../rom/model/online.hpp"
#include "../../harness/growth.hpp"
#include "../../harness/interrupt.hpp"
#include "../../harness/paper_study.hpp"
#include "../../harness/progress.hpp"
#include "../../harness/report.hpp"
#include "../../harness/timing.hpp"

namespace tact::bench {
namespace {

Json series(const std::string& of, const std::string& with, const std::string& unit, Json points) {
    std::vector<double> x, seconds, bytes;
    for (const Json& point : points) {
        if (!point["seconds"].is_number()) continue;
        x.push_back(point["x"]);
        seconds.push_back(point["seconds"]);
        if (point.contains("bytes")) bytes.push_back(point["bytes"]);
    }
    return {{"of", of},
            {"with", with},
            {"unit", unit},
            {"exponent", fitted_exponent(x, seconds)},
            {"memory_exponent", bytes.size() == x.size() ? fitted_exponent(x, bytes) : Json()},
            {"points", std::move(points)}};
}

Json full_steps(const std::string& scene, std::vector<Index> sides, double t_end) {
    const Json growth = run_growth({.scene = scene, .sides = std::move(sides), .t_end = t_end});
    Json points = Json::array();
    for (const Json& point : growth["points"])
        if (point.contains("unknowns"))
            points.push_back(
                {{"x", point["unknowns"]}, {"seconds", point["contact_seconds"]}, {"bytes", point["peak_bytes"]}});
    return series("full " + scene, "unknowns", "a step in contact", std::move(points));
}

/// A flat obstacle that rises under the loaded membrane.
Json touched_rows_of_the_membrane(Index n) {
    const ContactProblem membrane = MembraneFamily(n).at(Eigen::Vector2d(0.45, 0.4));
    const Vector load = membrane.f.at(0);
    Json points = Json::array();
    for (const double height : {-0.72, -0.68, -0.6, -0.45, -0.25}) {
        throw_if_interrupted();
        const Vector c = Vector::Constant(membrane.constraints(), height);
        Vector u, lambda;
        ContactReport report;
        const double seconds = median_seconds(3, [&] {
            u.setZero(membrane.size());
            lambda.setZero(membrane.constraints());
            report = AutomaticContact().prepare(membrane.K, membrane.B)->solve(load, c, {u, lambda});
        });
        if (report.outcome != Outcome::converged) throw NumericalError("growth: a static solve did not converge");
        points.push_back({{"x", report.active}, {"seconds", seconds}});
    }
    return series("full static membrane over a flat obstacle", "rows in contact", "a cold solve", std::move(points));
}

/// Bases of every size from one run of the plates.
class ReducedPlates {
public:
    explicit ReducedPlates(Index n)
        : scene_(study_scene("two-plates", n)),
          problem_(scene_.family->at(Parameter())),
          primal_({.max_vectors = 400}),
          dual_(problem_.constraints()) {
        const TimeGrid grid = TimeGrid::until(scene_.t_end, scene_.dt);
        SnapshotRecorder recorder(problem_.size(), grid.steps, {}, dual_,
                                  [this](const Eigen::Ref<const DenseMatrix>& block) { primal_.add(block); });
        const std::vector<Observer> record{recorder.observer(), stop_on_interrupt()};
        ContactWorkspace workspace(std::make_shared<AutomaticContact>());
        const MarchReport march = integrate(Bdf2(), problem_, grid, workspace, record);
        throw_if_interrupted();
        if (march.outcome != Outcome::converged) throw NumericalError("growth: the plates did not converge");
        recorder.flush();
    }
    /// CPU seconds of a whole reduced march.
    double march(Index p, Index p_lambda, long steps) const {
        BasisRecipe recipe;
        recipe.sizes = {p, p_lambda};
        recipe.dual_basis = selected_rows();
        const ContactProblem reduced = reduce(problem_, compressed_basis(problem_, primal_, dual_, recipe).basis);
        ContactWorkspace workspace(std::make_shared<DenseContact>(DenseContactOptions{.compliance = 0.3}));
        const TimeGrid grid = TimeGrid::until(scene_.dt * static_cast<double>(steps), scene_.dt);
        const auto run = [&] {
            if (integrate(Bdf2(), reduced, grid, workspace).outcome != Outcome::converged)
                throw NumericalError("growth: reduced plates did not converge");
        };
        run();
        return median_seconds(5, run);
    }
    long steps() const { return TimeGrid::until(scene_.t_end, scene_.dt).steps; }

private:
    StudyScene scene_;
    ContactProblem problem_;
    PodAccumulator primal_;
    DualSnapshots dual_;
};

void add_reduced(Json& rows, bool small) {
    const ReducedPlates plates(small ? 20 : 100);
    const long steps = plates.steps();
    const auto per_step = [&](Index p, Index p_lambda) {
        throw_if_interrupted();
        return plates.march(p, p_lambda, steps) / static_cast<double>(steps);
    };
    Json points = Json::array();
    for (const Index p : {10, 20, 40, 80, 150}) points.push_back({{"x", p}, {"seconds", per_step(p, p / 2)}});
    rows.push_back(series("reduced plates, p_lambda = p / 2", "p", "a step", std::move(points)));
    points = Json::array();
    for (const Index m : {10, 20, 40, 80, 160}) points.push_back({{"x", m}, {"seconds", per_step(80, m)}});
    rows.push_back(series("reduced plates, p = 80", "p_lambda", "a step", std::move(points)));
    points = Json::array();
    for (const long count : {125L, 250L, 500L, 1000L, 2000L})
        points.push_back({{"x", count}, {"seconds", plates.march(40, 20, count)}});
    rows.push_back(series("reduced plates, p = 40", "steps", "a march", std::move(points)));
}

void add_queries(Json& rows, bool small) {
    const PaperStudy study = paper_study("static-obstacle", small);
    const TrainingResult trained = train_with_progress(study, {}, paper_training(study));
    const ContactFamily& family = *study.scene.family;
    const auto model = std::make_shared<ReducedModel>(build_reduced_model(family, trained.basis, {}));
    const Online online(model, {std::make_shared<DenseContact>(), nullptr});
    const auto ask = [&](const std::vector<Parameter>& gammas, int threads) {
        for (const Answer& answer : online.solve_many(gammas, threads))
            if (answer.outcome != Outcome::converged) throw NumericalError("growth: a query did not converge");
    };
    const auto asked = [&](Index count) { return latin_hypercube(family.lower(), family.upper(), count, 1); };
    Json points = Json::array();
    for (const Index count : {100, 1000, small ? 2000 : 10000}) {
        const std::vector<Parameter> gammas = asked(count);
        points.push_back({{"x", count}, {"seconds", median_seconds(3, [&] { ask(gammas, 1); })}});
    }
    rows.push_back(series("a reduced static model", "queries", "all queries", std::move(points)));
    points = Json::array();
    const std::vector<Parameter> many = asked(small ? 2000 : 50000);
    for (const int threads : {1, 2, 4}) {
        std::vector<double> walls;
        for (int k = 0; k < 5; ++k) {
            throw_if_interrupted();
            const auto start = std::chrono::steady_clock::now();
            ask(many, threads);
            walls.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
        }
        points.push_back({{"x", threads}, {"seconds", median(walls)}});
    }
    rows.push_back(series("a reduced static model", "threads", "many queries, wall time", std::move(points)));
}

}  // namespace

Json run_growth_study(const StudyOptions& options) {
    check_scenes("growth", options, {});
    Json json{{"study", "growth"}, {"size", options.small ? "small" : "full"}, {"machine", machine()}};
    Json& rows = json["rows"] = Json::array();
    rows.push_back(full_steps(
        "dynamic-obstacle", options.small ? std::vector<Index>{25, 50} : std::vector<Index>{50, 100, 200, 400}, 0.5));
    rows.push_back(full_steps(
        "two-plates", options.small ? std::vector<Index>{15, 25} : std::vector<Index>{25, 50, 100, 150}, 0.02));
    Progress progress("growth: touched rows, reduced models, queries", 3);
    rows.push_back(touched_rows_of_the_membrane(options.small ? 60 : 200));
    progress.add(1);
    add_reduced(rows, options.small);
    progress.add(1);
    add_queries(rows, options.small);
    return json;
}

std::string growth_table(const Json& json) {
    std::vector<std::vector<std::string>> lines{
        {"of", "with", "unit", "from", "to", "seconds from", "to", "exponent", "memory, exponent"}};
    for (const Json& row : json["rows"]) {
        const Json &first = row["points"].front(), &last = row["points"].back();
        lines.push_back({row["of"].get<std::string>(), row["with"].get<std::string>(), row["unit"].get<std::string>(),
                         digits(first["x"]), digits(last["x"]), with_unit(first["seconds"]),
                         with_unit(last["seconds"]), digits(row["exponent"]), digits(row["memory_exponent"])});
    }
    return table(lines);
}

std::string growth_markdown(const Json& json) {
    return "# Growth\n\nSize: " + json["size"].get<std::string>() + ". " + machine_line(json["machine"]) +
           ".\n\n![time against size](growth.svg)\n\n" + growth_table(json) +
           "\nCPU time of one thread (of threads: wall time), medians; exponents are slopes fitted over logarithms. "
           "Full models: "
           "the median step in contact at the same physical time, memory the peak of the whole run. Larger grids: "
           "[solvers](solvers.md).\n";
}

const Study& growth_study() {
    static const Study study =
        study_of_scenes("growth", "Time and memory against size, contact, bases, steps, queries and threads",
                        Measured::elapsed_time, run_growth_study, growth_table, growth_markdown);
    return study;
}

}  // namespace tact::bench
