#include "histories.hpp"

#include <array>
#include <cmath>

#include "../../harness/basis_errors.hpp"
#include "../../harness/interrupt.hpp"
#include "../../harness/paper_study.hpp"

#include "../../../lib/time/trajectory.hpp"

namespace tact::bench {
namespace {

struct Place {
    double x, y;
    std::size_t body = 0;
};

Json rounded(double x) { return std::round(1e6 * x) / 1e6 + 0.0; }

Json values_at(const Mesh& mesh, const ConstVectorRef& u, const std::vector<Place>& places) {
    Json values = Json::array();
    for (const Place& at : places) values.push_back(rounded(value_at(mesh, u, at.x, at.y, at.body)));
    return values;
}

/// The states of one run: of the full problem as they are, of a reduced one with the basis they are to be lifted with.
struct States {
    DenseMatrix q;
    const DenseMatrix* U = nullptr;
    Vector at(Index j) const { return U ? Vector(*U * q.col(j)) : Vector(q.col(j)); }
};

/// A trained scene, and its variant with singular vectors for the dual basis.
struct Trained {
    PaperStudy study;
    Scheme scheme;
    TrainingResult result;
    std::unique_ptr<ContactFamily> by_singular_vectors;  ///< on the same U and the same snapshots
};

Trained trained(PaperStudy study) {
    Trained made{.study = std::move(study), .scheme = {}, .result = {}, .by_singular_vectors = {}};
    made.scheme = paper_scheme(made.study.scene);
    DenseMatrix singular;
    TrainingOptions training = paper_training(made.study);
    const Index last = training.sizes(training.max_iterations).p_lambda;
    training.dual_basis = [&singular, last, usual = training.dual_basis](const DualBasisInput& input) {
        if (input.size == last)
            singular = singular_vectors()({input.snapshots, input.B, input.U, input.size}).U_lambda;
        return usual(input);
    };
    made.result = train_with_progress(made.study, {made.scheme.integrator, made.scheme.grid}, training);
    if (singular.cols() > 0)
        made.by_singular_vectors = reduce(made.study.scene.family, {made.result.basis.U, singular, DualSigns::any});
    return made;
}

States reduced_states(const Trained& made, const Parameter& gamma) {
    ContactWorkspace workspace(study_contact().reduced);
    const FullStates states =
        full_states({.name = made.study.scene.name + ", reduced", .family = made.result.reduced}, made.scheme,
                    {gamma}, workspace);
    return {states.u, &made.result.basis.U};
}

/// Rows of mixed signs make penetration of open gaps: the run starts from what it is given all the same.
States singular_states(const Trained& made, const Parameter& gamma) {
    const ContactProblem problem = made.by_singular_vectors->at(gamma);
    ContactWorkspace workspace(study_contact().reduced);
    Trajectory trajectory(problem, made.scheme.grid.steps, {.stride = 1, .initial = true, .multipliers = false});
    const std::array observers{trajectory.observer()};
    (void)run("singular vectors", problem, made.scheme, workspace, observers,
              {.initial_penetration = InitialPenetration::accept});
    return {trajectory.u(), &made.result.basis.U};
}

double squared_percent(const States& reduced, const DenseMatrix& full) {
    return 100 * squared_distances(*reduced.U, reduced.q, full).sum() / full.squaredNorm();
}

/// What one run is drawn of.
struct Drawn {
    std::string figures, claim;
    Parameter gamma;
    std::vector<Place> history = {};    ///< points shown over time
    std::vector<double> surfaces = {};  ///< times shown all over the square; 0 in statics
    bool slice = false;                 ///< the cut y = 1/2 with the obstacle
};

Json numbers(const Parameter& gamma) { return std::vector<double>(gamma.begin(), gamma.end()); }

Json slice_of(const Trained& made, const Drawn& drawn, const Vector& full, const Vector& reduced) {
    std::vector<Place> cut;
    Json x = Json::array();
    for (int k = 2; k <= 98; ++k) {
        cut.push_back({k / 100.0, 0.5});
        x.push_back(k / 100.0);
    }
    const Mesh& mesh = made.study.scene.mesh;
    const Vector obstacle = made.study.scene.family->at(drawn.gamma).c.at(0);
    return {{"figures", drawn.figures},
            {"scene", made.study.scene.name},
            {"gamma", numbers(drawn.gamma)},
            {"x", x},
            {"obstacle", values_at(mesh, obstacle, cut)},
            {"full", values_at(mesh, full, cut)},
            {"reduced", values_at(mesh, reduced, cut)}};
}

Json surface_of(const Trained& made, const Drawn& drawn, double t, std::size_t body, const Vector& full,
                const Vector& reduced) {
    constexpr int side = 41;
    std::vector<Place> places;
    for (int j = 0; j < side; ++j)
        for (int i = 0; i < side; ++i) places.push_back({i / (side - 1.0), j / (side - 1.0), body});
    const Mesh& mesh = made.study.scene.mesh;
    return {{"figures", drawn.figures},
            {"scene", made.study.scene.name},
            {"gamma", numbers(drawn.gamma)},
            {"t", t},
            {"body", body},
            {"side", side},
            {"full", values_at(mesh, full, places)},
            {"reduced", values_at(mesh, reduced, places)}};
}

/// Some 400 instants of the march at a few points.
Json history_of(const Trained& made, const Drawn& drawn, const States& full, const States& reduced,
                const States* singular) {
    const TimeGrid& grid = made.scheme.grid;
    const long stride = std::max(1L, grid.steps / 400);
    Json json{{"figures", drawn.figures},
              {"scene", made.study.scene.name},
              {"gamma", numbers(drawn.gamma)},
              {"t", Json::array()},
              {"points", Json::array()}};
    for (long n = 0; n <= grid.steps; n += stride) json["t"].push_back(rounded(grid.t(n)));
    for (const Place& place : drawn.history) {
        Json point{{"x", place.x}, {"y", place.y}, {"body", place.body}};
        const auto curve = [&](const States& states) {
            Json values = Json::array();
            const DenseMatrix* U = states.U;
            Vector weights(U ? U->cols() : 0);
            for (Index j = 0; U && j < U->cols(); ++j)
                weights[j] = value_at(made.study.scene.mesh, U->col(j), place.x, place.y, place.body);
            for (long n = 0; n <= grid.steps; n += stride)
                values.push_back(
                    rounded(U ? weights.dot(states.q.col(n))
                              : value_at(made.study.scene.mesh, states.q.col(n), place.x, place.y, place.body)));
            return values;
        };
        point["full"] = curve(full);
        point["reduced"] = curve(reduced);
        point["singular_vectors"] = singular ? curve(*singular) : Json();
        json["points"].push_back(std::move(point));
    }
    return json;
}

/// Of a row with singular vectors: a march that fails with them is as poor as can be.
Json claim_of(const Json& row) {
    constexpr double poor = 10, good = 2;  // times NNMF's error; %
    const Json& singular = row["singular_vectors_error_percent"];
    const double error = row["relative_error_percent"];
    const Json times = singular.is_number() ? Json(singular.get<double>() / error) : Json();
    return {
        {"scene", row["scene"]},
        {"claim", "figures " + row["figures"].get<std::string>() +
                      ": a dual basis by NNMF tracks the full run, one by singular vectors is poor: its error over "
                      "that of NNMF, squared as printed"},
        {"paper", "poor"},
        {"figure", times.is_number() ? times : Json("fails")},
        {"holds", error < good && (times.is_null() || times.get<double>() > poor)}};
}

void draw(const Trained& made, const Drawn& drawn, Json& json) {
    const PaperStudy& study = made.study;
    Progress progress(study.scene.name + ": figures " + drawn.figures, 3);
    ContactWorkspace workspace(study_contact().full);
    const States full{full_states(study.scene, made.scheme, {drawn.gamma}, workspace).u};
    progress.add(1);
    const States reduced = reduced_states(made, drawn.gamma);
    const double percent = squared_percent(reduced, full.q);
    progress.add(1);
    Json row{{"figures", drawn.figures},
             {"scene", study.scene.name},
             {"gamma", numbers(drawn.gamma)},
             {"p", made.result.basis.primal_size()},
             {"p_lambda", made.result.basis.dual_size()},
             {"relative_error_percent", percent},
             {"relative_error_norm", std::sqrt(percent / 100)},
             {"singular_vectors_error_percent", nullptr},
             {"claim", drawn.claim}};
    std::optional<States> singular;
    if (made.by_singular_vectors) {
        try {
            singular = singular_states(made, drawn.gamma);
            row["singular_vectors_error_percent"] = squared_percent(*singular, full.q);
        } catch (const NumericalError& error) {
            row["singular_vectors_outcome"] = error.what();  // of a basis that is shown because it is bad
        }
    }
    if (made.by_singular_vectors) json["claims"].push_back(claim_of(row));
    json["rows"].push_back(std::move(row));
    if (drawn.slice) json["slices"].push_back(slice_of(made, drawn, full.at(0), reduced.at(0)));
    if (!drawn.history.empty())
        json["histories"].push_back(history_of(made, drawn, full, reduced, singular ? &*singular : nullptr));
    for (const double t : drawn.surfaces) {
        const Index j = made.scheme.integrator ? std::lround(t / made.scheme.grid.dt) : 0;
        for (std::size_t body = 0; body < study.scene.mesh.bodies.size(); ++body)
            json["surfaces"].push_back(surface_of(made, drawn, t, body, full.at(j), reduced.at(j)));
    }
}

}  // namespace

Json run_histories(const StudyOptions& options) {
    check_scenes("histories", options, {"static-obstacle", "dynamic-obstacle", "two-plates"});
    Json json;
    json["study"] = "histories";
    json["size"] = options.small ? "small" : "full";
    json["machine"] = machine();
    for (const char* part : {"rows", "claims", "slices", "histories", "surfaces"}) json[part] = Json::array();
    const auto gamma = [](double g1, double g2) { return Parameter(Eigen::Vector2d(g1, g2)); };
    const std::vector<Place> points{{0.5, 0.5}, {0.25, 0.25}, {0.7, 0.5}}, centres{{0.5, 0.5, 0}, {0.5, 0.5, 1}};
    if (options.wants("static-obstacle")) {
        const Trained still = trained(paper_study("static-obstacle", options.small));
        draw(still, {"4 (a)", "almost indistinguishable", gamma(0.6, 0.6), {}, {}, true}, json);
        draw(still, {"4 (b), 5", "almost indistinguishable", gamma(0.33, 0.377), {}, {0}, true}, json);
    }
    if (options.wants("dynamic-obstacle")) {
        const Trained moving = trained(paper_study("dynamic-obstacle", options.small));
        const std::string claim = "tracks the full run well; singular vectors perform poorly";
        draw(moving, {"7", claim, gamma(0.6, 0.6), points}, json);
        draw(moving, {"8, 9", claim, gamma(0.3, 0.288), points, {0.2}}, json);
    }
    if (options.wants("two-plates"))
        draw(trained(paper_study("two-plates", options.small)),
             {"11, 12", "tracks the full run remarkably well", {}, centres, {0.4}}, json);
    return json;
}

}  // namespace tact::bench
