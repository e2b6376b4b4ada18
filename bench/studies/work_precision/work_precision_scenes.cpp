#include "work_precision_scenes.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "../../../contact/automatic.hpp"
#include "../../../lib/errors.hpp"
#include "../../../lib/scenes/bar.hpp"
#include "../../../lib/scenes/membrane.hpp"
#include "../../../lib/sparse/klu_solver.hpp"
#include "../../harness/report.hpp"
#include "../../harness/scenes.hpp"
#include "work_precision_gsl.hpp"
#include "work_precision_run.hpp"

namespace tact::bench {
namespace {

using Reference_ = std::shared_ptr<const Reference>;

std::vector<long> doubled(long coarsest, int grids) {
    std::vector<long> steps{coarsest};
    while (static_cast<int>(steps.size()) < grids) steps.push_back(2 * steps.back());
    return steps;
}

std::vector<double> decades(int from, int to) {
    std::vector<double> all;
    for (int k = from; k >= to; --k) all.push_back(std::pow(10.0, k));
    return all;
}

PrecisionScene scene_of(ContactProblem problem, double t_end, std::vector<long> steps, long outputs) {
    PrecisionScene scene;
    scene.problem = std::move(problem);
    scene.contact = std::make_shared<AutomaticContact>();
    scene.t_end = t_end;
    scene.steps = std::move(steps);
    scene.tolerances = decades(-2, -7);
    scene.outputs = outputs;
    return scene;
}

std::vector<double> times_of(const PrecisionScene& scene) {
    std::vector<double> times;
    for (long k = 1; k <= scene.outputs; ++k) times.push_back(scene.output(k));
    return times;
}

/// The same reference for every method, made once.
void compare_with(PrecisionScene& scene, std::function<Reference()> make) {
    scene.reference = [make = std::move(make), made = std::make_shared<Reference_>()](const PrecisionMethod&) {
        if (!*made) *made = std::make_shared<const Reference>(make());
        return *made;
    };
}

/// Known at every time: the motion at the nodes and the contact force's impulse.
void compare_with_exact(PrecisionScene& scene, const StudyScene& study, std::function<double(double)> impulse) {
    const auto times = times_of(scene);
    compare_with(scene, [times, exact = study.exact, impulse = std::move(impulse), n = scene.problem.size()] {
        Reference reference{"the exact motion", DenseMatrix(n, static_cast<Index>(times.size())),
                            Vector(static_cast<Index>(times.size()))};
        for (std::size_t k = 0; k < times.size(); ++k) {
            reference.u.col(static_cast<Index>(k)) = exact(times[k]).u;
            reference.impulse[static_cast<Index>(k)] = impulse(times[k]);
        }
        return reference;
    });
}

/// A run of `method` itself with many steps; half as many say how accurate it is.
Reference refined(const PrecisionScene& scene, const PrecisionMethod& method, long steps) {
    const auto march = [&](long count) {
        Recorded recorded = record(method, static_cast<double>(count), scene, Ledgers::none);
        if (recorded.outcome != Outcome::converged)
            throw NumericalError("reference: " + method.label() + " in " + std::to_string(count) +
                                 " steps: " + std::string(to_string(recorded.outcome)));
        return recorded;
    };
    const Recorded coarse = march(steps / 2);
    Recorded fine = march(steps);
    Reference reference{method.label() + " in " + std::to_string(steps) + " steps", std::move(fine.u),
                        std::move(fine.impulse)};
    reference.own_error_u = error_u(scene, coarse.u, reference);
    reference.own_error_lambda = error_lambda(coarse.impulse, reference);
    return reference;
}

// A bar that rests on the wall under its weight while the weight swells and fades: contact never ends.
constexpr double swell = 0.5, period = 2;
double swelling(double t) {
    const double wave = (1 - std::cos(2 * std::numbers::pi * t / period)) / 2;
    return 1 + swell * wave * wave;
}

/// The held bar without its contact node, whose u is zero for ever; the last component is the impulse.
OrdinaryProblem condensed(const ContactProblem& problem) {
    const Index n = problem.size() - 1;
    const SparseMatrix K = problem.K.to_sparse();
    const Vector mass = *problem.M->diagonal_entries();
    const Vector load = problem.f.modes.col(0);
    OrdinaryProblem result;
    result.y0 = Vector::Zero(2 * n + 1);
    result.y0.head(n) = problem.u0.tail(n);
    result.derivative = [n, K, mass, load](double t, const double* y, double* out) {
        Vector u = Vector::Zero(n + 1);
        u.tail(n) = Eigen::Map<const Vector>(y, n);
        const Vector force = swelling(t) * load - K * u;
        Eigen::Map<Vector>(out, n) = Eigen::Map<const Vector>(y + n, n);
        Eigen::Map<Vector>(out + n, n) = force.tail(n).cwiseQuotient(mass.tail(n));
        out[2 * n] = -force[0];
    };
    return result;
}

PrecisionScene held_bar(bool small) {
    const Index elements = small ? 50 : 100;
    ContactProblem problem =
        bar_impact(elements, {.length = 1, .density = 1, .modulus = 1, .velocity = 0, .gap = 0, .gravity = 1})
            .problem;
    const Vector weight = problem.f.at(0);
    problem.f = AffineVector(DenseMatrix(weight), [](double t, Side, VectorRef out) { out[0] = swelling(t); });
    const Vector x = Vector::LinSpaced(elements + 1, 0, 1);
    problem.u0 = x.array() * (x.array() / 2 - 1);  // its rest: linear elements are exact at the nodes
    PrecisionScene scene = scene_of(std::move(problem), 4, doubled(40, small ? 6 : 8), 40);
    scene.impacts = false;
    scene.tolerances = decades(-3, small ? -8 : -9);
    scene.what = "a bar of " + std::to_string(elements) +
                 " elements that rests on the wall while its weight swells and fades, smoothly and without an impact";
    compare_with(scene, [times = times_of(scene), given = scene.problem, partial = scene] {
        const Index n = given.size() - 1;
        const OrdinaryProblem equations = condensed(given);
        const auto solve = [&](double tolerance) {
            const OrdinaryRun run = solve_ordinary("rk8pd", equations, times, tolerance, 1e-3 * tolerance, infinity);
            if (!run.failure.empty()) throw NumericalError("held-bar: reference: " + run.failure);
            Reference reference{"GSL's rk8pd, tolerance 1e-12, on the bar without its contact node",
                                DenseMatrix::Zero(n + 1, run.y.cols()), run.y.row(2 * n).transpose()};
            reference.u.bottomRows(n) = run.y.topRows(n);
            return reference;
        };
        const Reference coarse = solve(1e-10);
        Reference fine = solve(1e-12);
        fine.own_error_u = error_u(partial, coarse.u, fine);
        fine.own_error_lambda = error_lambda(coarse.impulse, fine);
        return fine;
    });
    return scene;
}

PrecisionScene free_membrane(bool small) {
    const Index n = small ? 6 : 12;
    const MembraneFamily family(n, Motion::dynamic);
    ContactProblem problem = family.at(Eigen::Vector2d(0.45, 0.4));
    problem.B = Matrix::without_rows(problem.size());
    problem.c = Vector(0);
    PrecisionScene scene = scene_of(std::move(problem), 2, doubled(40, small ? 6 : 8), 40);
    scene.contact = std::make_shared<WithoutContact>(std::make_shared<KluSolver>());
    scene.tolerances = decades(-3, small ? -8 : -9);
    scene.gsl = true;
    scene.impacts = false;
    scene.what = "a membrane of " + std::to_string(n) + " x " + std::to_string(n) +
                 " nodes let go under its load, nothing in its way";
    compare_with(scene, [times = times_of(scene), given = scene.problem] {
        // Modes: M is a multiple of the identity.
        const double mass = (*given.M->diagonal_entries())[0];
        const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> modes(given.K.to_dense());
        const Vector rest = modes.eigenvectors().transpose() * given.f.at(0);
        const Vector still = rest.cwiseQuotient(modes.eigenvalues());
        const Vector frequency = (modes.eigenvalues() / mass).cwiseSqrt();
        Reference reference{"the exact motion of its modes",
                            DenseMatrix(given.size(), static_cast<Index>(times.size())),
                            Vector::Zero(static_cast<Index>(times.size()))};
        for (std::size_t k = 0; k < times.size(); ++k)
            reference.u.col(static_cast<Index>(k)) =
                modes.eigenvectors() * (still.array() * (1 - (frequency.array() * times[k]).cos())).matrix();
        return reference;
    });
    return scene;
}

PrecisionScene impact(const std::string& name, bool small) {
    const StudyScene study = study_scene(name, small ? 100 : 1000);
    PrecisionScene scene = scene_of(study.family->at({}), study.t_end, doubled(60, small ? 6 : 10), 30);
    scene.tolerances = decades(-1, -6);
    scene.what = "an elastic bar of " + std::to_string(study.n) + " elements that meets a wall and leaves it";
    scene.siconos = name == "bar-impact";
    compare_with_exact(scene, study, [](double t) { return 300 * std::clamp(t - 0.5, 0.0, 2.0 / 3); });
    return scene;
}

PrecisionScene bouncing(const std::string& name, bool small) {
    const StudyScene study = study_scene(name, small ? 30 : 100);
    const double periods = small ? 2 : 10;
    PrecisionScene scene =
        scene_of(study.family->at({}), 3 * periods, doubled(small ? 120 : 600, small ? 6 : 7), small ? 60 : 300);
    scene.tolerances = decades(-1, -6);
    scene.what = "GetFEM's bar of " + std::to_string(study.n) + " elements that bounces for ever, " +
                 digits(periods) + " periods";
    compare_with_exact(scene, study, [](double t) {
        const double whole = std::floor(t / 3);
        return 0.5 * (whole + std::clamp(t - 3 * whole - 1, 0.0, 1.0));
    });
    return scene;
}

/// Limits of refinement: one for the schemes with e = 0, one for BDF, one for each Runge-Kutta table.
std::string family_of(const PrecisionMethod& method) {
    if (method.mean_force || method.has_impact_law()) return "trapezoid";
    return method.name.rfind("ida", 0) == 0 ? "bdf2" : method.name;
}

PrecisionScene membrane(bool small) {
    const StudyScene study = study_scene("dynamic-obstacle", small ? 12 : 200);
    const std::vector<long> full_steps{50, 100, 150, 200, 300, 400};
    PrecisionScene scene = scene_of(study.family->at(Eigen::Vector2d(0.6, 0.6)), study.t_end,
                                    small ? doubled(25, 6) : full_steps, small ? 25 : 50);
    scene.tolerances = small ? decades(-1, -6) : std::vector<double>{0.1, 0.03, 0.01, 3e-3, 1e-3, 3e-4};
    scene.what = "the paper's membrane of " + std::to_string(study.n) + " x " + std::to_string(study.n) +
                 " nodes, gamma = (.6, .6)";
    const long finest = scene.steps.back();
    scene.reference = [partial = scene, finest,
                       made = std::make_shared<std::map<std::string, Reference_>>()](const PrecisionMethod& method) {
        const std::string family = family_of(method);
        Reference_& reference = (*made)[family];
        if (!reference) {
            const PrecisionMethod own{family, false, family == "trapezoid"};
            const bool runge_kutta = family != "trapezoid" && family != "bdf2";
            reference =
                std::make_shared<const Reference>(refined(partial, own, runge_kutta ? 2 * finest : 4 * finest));
        }
        return reference;
    };
    return scene;
}

PrecisionScene plates(bool small, Index n) {
    const StudyScene study = study_scene("two-plates", n);
    // The blow falls on the end of a step: at .002 s.
    const std::vector<long> full_steps{200, 400, 600, 1000, 1400, 2000}, small_steps{25, 50, 125, 250, 500, 1000};
    PrecisionScene scene = scene_of(study.family->at({}), small ? study.t_end / 8 : study.t_end,
                                    small ? small_steps : full_steps, small ? 25 : 200);
    scene.tolerances = small ? decades(-1, -6) : std::vector<double>{0.1, 0.03, 0.01, 3e-3, 1e-3, 3e-4};
    scene.what = "the two plates of " + std::to_string(study.n) + " x " + std::to_string(study.n) + " nodes";
    const long finest = scene.steps.back();
    compare_with(scene, [partial = scene, finest] {
        return refined(partial, {"trapezoid", false, true}, 8 * finest);
    });
    return scene;
}

const std::map<std::string, std::function<PrecisionScene(const std::string&, bool)>>& makers() {
    static const std::map<std::string, std::function<PrecisionScene(const std::string&, bool)>> all{
        {"held-bar", [](const std::string&, bool small) { return held_bar(small); }},
        {"free-membrane", [](const std::string&, bool small) { return free_membrane(small); }},
        {"bar-impact", impact},
        {"bar-impact-redistributed", impact},
        {"bouncing-bar", bouncing},
        {"bouncing-bar-redistributed", bouncing},
        {"dynamic-obstacle", [](const std::string&, bool small) { return membrane(small); }},
        {"two-plates", [](const std::string&, bool small) { return plates(small, small ? 8 : 100); }},
        {"two-plates-coarse", [](const std::string&, bool small) {
             PrecisionScene scene = plates(small, small ? 6 : 16);
             scene.siconos = true;
             return scene;
         }}};
    return all;
}

}  // namespace

std::vector<std::string> precision_scene_names() {
    return {"held-bar",         "free-membrane",
            "bar-impact",       "bar-impact-redistributed",
            "bouncing-bar",     "bouncing-bar-redistributed",
            "dynamic-obstacle", "two-plates",
            "two-plates-coarse"};
}

PrecisionScene precision_scene(const std::string& name, bool small) {
    const auto found = makers().find(name);
    if (found == makers().end()) {
        std::string names;
        for (const std::string& each : precision_scene_names()) names += (names.empty() ? "" : ", ") + each;
        throw InputError("precision_scene: name is " + name + ", expected one of " + names);
    }
    PrecisionScene scene = found->second(name, small);
    scene.name = name;
    return scene;
}

}  // namespace tact::bench
