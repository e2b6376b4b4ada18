#include "stability_cases.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "../../../lib/scenes/bar.hpp"
#include "../../../lib/scenes/mass_on_stop.hpp"
#include "../../../lib/scenes/membrane.hpp"
#include "../../../lib/scenes/plates.hpp"

namespace tact::bench {
namespace {

using Cases = std::vector<StabilityCase>;
using Exact = std::function<Vector(double t, double restitution)>;

std::string power(double x) {
    const auto exponent = std::lround(std::log10(x));
    return "1e" + std::to_string(exponent);
}

TimeGrid steps_over(double t_end, double dt, long least, long most) {
    return {dt, std::clamp(std::lround(std::ceil(t_end / dt)), least, most)};
}

/// A bar thrown at a wall: what happens does not depend on the restitution of its last node as the elements shrink.
StabilityCase thrown_bar(std::string group, std::string name, Index elements, const BarImpactData& data,
                         const TimeGrid& grid) {
    const Scene scene = bar_impact(elements, data);
    StabilityCase c{.group = std::move(group), .name = std::move(name), .problem = scene.problem, .grid = grid};
    c.length = std::max(data.gap, std::abs(data.velocity) * grid.t(grid.steps));
    if (data.gravity == 0)
        c.exact = [line = scene.mesh.bodies[0].line, data](double t, double) {
            return Vector(line.unaryExpr([&](double x) { return bar_impact_exact(data, x, t).u; }));
        };
    return c;
}

StabilityCase bouncing_mass(std::string group, std::string name, const MassOnStopData& data, const TimeGrid& grid) {
    StabilityCase c{
        .group = std::move(group), .name = std::move(name), .problem = mass_on_stop(data).problem, .grid = grid};
    c.length = std::max(data.height, 1e-300);
    c.exact = [data](double t, double restitution) {
        if (std::isnan(restitution)) return Vector();
        return Vector(Vector::Constant(1, bouncing_ball(data, restitution, t).u));
    };
    return c;
}

/// Rigid masses, springs and rows, at rest under no load unless given.
ContactProblem masses(const Vector& mass, const DenseMatrix& K, const DenseMatrix& B, const Vector& u0,
                      const Vector& v0) {
    ContactProblem p;
    p.M = Matrix::diagonal(mass);
    p.K = Matrix(K);
    p.B = Matrix(B);
    p.c = Vector(Vector::Zero(B.rows()));
    p.f = Vector(Vector::Zero(mass.size()));
    p.u0 = u0;
    p.v0 = v0;
    return p;
}

void step_lengths(Cases& cases, Index n, long most) {
    const double bar_period = 2 * 10 / 30.0, spring_period = std::numbers::pi;
    for (int k = -3; k <= 3; ++k) {
        const double ratio = std::pow(10.0, k);
        StabilityCase bar = thrown_bar("step", "bar, dt = " + power(ratio) + " of its period", n, {},
                                       steps_over(1.5, ratio * bar_period, 60, most));
        bar.fixed_steps = true;
        if (k <= -2) bar.error_limit = 0.2;
        cases.push_back(std::move(bar));
    }
    for (int k = -3; k <= 3; ++k) {
        const double ratio = std::pow(10.0, k);
        cases.push_back(bouncing_mass("step", "mass on a spring, dt = " + power(ratio) + " of its period",
                                      {.gravity = 0, .stiffness = 4},
                                      steps_over(10, ratio * spring_period, 60, most)));
        cases.back().fixed_steps = true;
    }
}

void stiffnesses(Cases& cases, Index n) {
    for (int k = -9; k <= 9; k += 3) {
        const double factor = std::pow(10.0, k);
        cases.push_back(thrown_bar("stiffness", "bar, E times " + power(factor), n, {.modulus = 900 * factor},
                                   {.dt = 0.01, .steps = 150}));
    }
    for (int k = -9; k <= 9; k += 6) {
        const double factor = std::pow(10.0, k);
        cases.push_back(bouncing_mass("stiffness", "mass on a spring of " + power(factor),
                                      {.gravity = 1, .stiffness = factor}, {.dt = 0.01, .steps = 300}));
    }
}

StabilityCase collision(const std::string& name, Index n, TwoBarsData data, bool exact) {
    data.left.elements = data.right.elements = n;
    const Scene scene = two_bars(data);
    StabilityCase c{.group = "ratio", .name = name, .problem = scene.problem, .grid = {0.01, 150}};
    c.length = 10;
    if (exact)
        c.exact = [mesh = scene.mesh, data](double t, double) {
            Vector u(mesh.unknowns());
            for (std::size_t body = 0; body < 2; ++body)
                for (Index i = 0; i < mesh.bodies[body].line.size(); ++i)
                    u[mesh.bodies[body].first + i] = two_bars_exact(data, mesh.bodies[body].line[i], t, body).u;
            return u;
        };
    return c;
}

/// Two plates of thicknesses 1 : ratio (stiffness with its cube), the lower one thrown at the upper one.
ContactProblem unequal_plates(Index n, double lower, double upper, double speed) {
    const Scene scene = two_plates(n, {.pressure = 0});
    ContactProblem p = scene.problem;
    const Index nodes = n * n;
    SparseMatrix K = p.K.to_sparse();
    for (Index column = 0; column < K.outerSize(); ++column)
        for (SparseMatrix::InnerIterator it(K, column); it; ++it)
            it.valueRef() *= std::pow(it.row() < nodes ? lower : upper, 3);
    Vector mass = p.M->main_diagonal();
    mass.head(nodes) *= lower;
    mass.tail(nodes) *= upper;
    p.K = Matrix(std::move(K));
    p.M = Matrix::diagonal(std::move(mass));
    p.f = Vector(Vector::Zero(2 * nodes));
    for (Index i = 0; i < nodes; ++i)
        p.v0[i] = speed * std::sin(std::numbers::pi * scene.mesh.x(i)) * std::sin(std::numbers::pi * scene.mesh.y(i));
    return p;
}

void ratios(Cases& cases, Index n, Index plate) {
    // Equal travel times L/c: the exact motion is known.
    cases.push_back(collision("light bar on heavy bar, 1e6, equal periods", n,
                              {.right = {.density = 1e6, .modulus = 900e6}}, true));
    cases.push_back(collision("soft bar on stiff bar, 1e9, equal periods", n,
                              {.right = {.length = 10 * std::sqrt(1e9), .modulus = 900e9}}, true));
    cases.push_back(collision("light bar on heavy bar, 1e6", n, {.right = {.density = 1e6}}, false));
    cases.push_back(collision("soft bar on stiff bar, 1e9", n, {.right = {.modulus = 900e9}}, false));
    cases.push_back({.group = "ratio",
                     .name = "plates, a thin one on one 100 times thicker",
                     .problem = unequal_plates(plate, 1, 100, 5),
                     .grid = {2e-4, 300}});
    cases.push_back({.group = "ratio",
                     .name = "plates, a thick one on one 100 times thinner",
                     .problem = unequal_plates(plate, 100, 1, 500),
                     .grid = {2e-5, 300}});
}

void gaps(Cases& cases, Index n) {
    const TimeGrid grid{0.01, 150};
    cases.push_back(thrown_bar("gap", "bar, gap zero", n, {.gap = 0}, grid));
    cases.push_back(thrown_bar("gap", "bar, gap 1e12", n, {.gap = 1e12}, grid));
    cases.back().error_limit = 1e-9;
    for (const InitialPenetration initial :
         {InitialPenetration::reject, InitialPenetration::project, InitialPenetration::accept}) {
        StabilityCase c{.group = "gap", .problem = bar_impact(n).problem, .grid = grid};
        c.problem.u0.array() -= 5.5;
        c.length = 5;
        c.initial = initial;
        c.rejected = initial == InitialPenetration::reject;
        c.name = std::string("bar, gap -0.5, ") + (c.rejected                               ? "rejected"
                                                   : initial == InitialPenetration::project ? "projected"
                                                                                            : "accepted");
        // The velocity that repairs it within one step is energy.
        if (initial == InitialPenetration::accept) c.energy_tolerance = infinity;
        cases.push_back(std::move(c));
    }
}

void speeds(Cases& cases, Index n) {
    for (int k = -6; k <= 6; k += 3) {
        const double speed = std::pow(10.0, k);
        cases.push_back(thrown_bar("speed", "bar at " + power(speed), n, {.velocity = -speed, .gap = 0.5 * speed},
                                   {.dt = 0.01, .steps = 150}));
        cases.back().error_limit = 0.3;
        StabilityCase mass =
            bouncing_mass("speed", "mass at " + power(speed), {.gravity = 0, .height = 1, .velocity = -speed},
                          {.dt = 0.01, .steps = 300});
        mass.length = std::max(1.0, speed);
        cases.push_back(std::move(mass));
    }
}

/// The bar in equilibrium on the wall under its weight.
Vector standing(const ContactProblem& bar) {
    const Index n = bar.size() - 1;
    Vector u = Vector::Zero(n + 1);
    u.tail(n) = bar.K.to_dense().bottomRightCorner(n, n).llt().solve(bar.f.at(0).tail(n));
    return u;
}

void persistent(Cases& cases, long steps) {
    const auto stays = [](const Vector& u) { return [u](double, double) { return u; }; };
    StabilityCase mass{.group = "rest",
                       .name = "mass under its weight",
                       .problem = mass_on_stop({.height = 0}).problem,
                       .grid = {0.01, steps}};
    mass.exact = stays(Vector::Zero(1));
    mass.energy = 1;
    mass.error_limit = 1e-9;
    cases.push_back(std::move(mass));
    StabilityCase bar{.group = "rest",
                      .name = "bar under its weight",
                      .problem = bar_impact(4, {.velocity = 0, .gap = 0, .gravity = 10}).problem,
                      .grid = {0.01, steps}};
    bar.problem.u0 = standing(bar.problem);
    bar.exact = stays(bar.problem.u0);
    bar.error_limit = 1e-8;
    cases.push_back(std::move(bar));
}

void grazing(Cases& cases) {
    // u = 1 + cos t touches the stop at t = pi without speed.
    StabilityCase c{.group = "graze", .name = "oscillator that touches the stop with zero speed", .grid = {}};
    c.problem = mass_on_stop({.gravity = 0, .stiffness = 1, .height = 2}).problem;
    c.problem.f = Vector(Vector::Ones(1));
    c.exact = [](double t, double) { return Vector(Vector::Constant(1, 1 + std::cos(t))); };
    c.error_limit = 0.05;
    for (const long per_half : {100L, 97L}) {  // on the grid and beside it
        c.grid = {std::numbers::pi / static_cast<double>(per_half) * (per_half == 97 ? 1.003 : 1), 3 * per_half};
        cases.push_back(c);
        c.name += ", beside the grid";
    }
}

Matrix repeated_rows(const Matrix& B, Index times) {
    const DenseMatrix rows = B.to_dense();
    return Matrix(SparseMatrix(DenseMatrix(rows.replicate(times, 1)).sparseView()));
}

StabilityCase with_rows(const std::string& name, const ContactProblem& problem, const Matrix& B, const Vector& c,
                        const TimeGrid& grid) {
    StabilityCase result{.group = "rows", .name = name, .problem = problem, .grid = grid};
    result.problem.B = B;
    result.problem.c = c;
    result.twin = problem;
    result.error_limit = 1e-6;
    return result;
}

void dependent_rows(Cases& cases, Index n) {
    const ContactProblem bar = bar_impact(n).problem;
    cases.push_back(
        with_rows("bar, its row three times", bar, repeated_rows(bar.B, 3), Vector::Zero(3), {0.01, 150}));
    const ContactProblem pair = masses(Vector::Ones(2), DenseMatrix{{1, -1}, {-1, 1}}, DenseMatrix::Identity(2, 2),
                                       Vector{{1, 1.5}}, Vector{{-1, -1}});
    cases.push_back(with_rows("two masses, a third row the sum of two", pair,
                              Matrix(DenseMatrix{{1, 0}, {0, 1}, {1, 1}}), Vector::Zero(3), {0.01, 300}));
    const ContactProblem membrane = MembraneFamily(6, Motion::dynamic).at(Eigen::Vector2d(0.6, 0.6));
    cases.push_back(with_rows("membrane, every row twice", membrane, repeated_rows(membrane.B, 2),
                              membrane.c.at(0).replicate(2, 1), {0.005, 200}));
}

void floating(Cases& cases, Index n) {
    cases.push_back(thrown_bar("floating", "bar in free flight", n, {.gap = 1000}, {0.01, 300}));
    cases.back().error_limit = 1e-9;
    cases.push_back(thrown_bar("floating", "bar that falls", n, {.velocity = 0, .gravity = 10}, {0.01, 300}));
    StabilityCase pair{.group = "floating", .name = "two rigid masses that meet", .grid = {0.01, 300}};
    pair.problem =
        masses(Vector{{1, 3}}, DenseMatrix::Zero(2, 2), DenseMatrix{{-1, 1}}, Vector{{0, 1}}, Vector{{1, 0}});
    pair.exact = [](double t, double e) {
        // They meet at t = 1; relative speed -e, centre of mass at speed 1/4.
        if (std::isnan(e)) return Vector();
        const double s = t - 1;
        return Vector(Vector{{1 + s * (0.25 - 0.75 * e), 1 + s * (0.25 + 0.25 * e)}});
    };
    pair.error_limit = 0.02;
    cases.push_back(std::move(pair));
}

void load_jumps(Cases& cases) {
    // Pressed by -1 up to t1, pulled by 2 up to t2, then free.
    for (const double shift : {0.0, 0.0033}) {
        const double t1 = 1 + shift, t2 = 2 + shift;
        StabilityCase c{.group = "load jump",
                        .name = shift == 0 ? "mass, jumps on the grid" : "mass, jumps beside the grid",
                        .grid = {0.01, 300}};
        c.problem = mass_on_stop({.height = 0}).problem;
        c.problem.f = AffineVector(DenseMatrix(DenseMatrix::Ones(1, 1)),
                                   [t1, t2](double t, Side side, VectorRef out) {
                                       const auto past = [&](double jump) {
                                           return side == Side::right ? t >= jump : t > jump;
                                       };
                                       out[0] = past(t2) ? 0 : past(t1) ? 2 : -1;
                                   },
                                   {t1, t2});
        c.exact = [t1, t2](double t, double) {
            const double s = t2 - t1;
            return Vector(Vector::Constant(1, s * s + 2 * s * (t - t2)));
        };
        c.error_limit = 0.05;
        c.energy_tolerance = 0.02;  // a load taken at the end of the step works one step early
        cases.push_back(std::move(c));
    }
}

ContactProblem spring_on_stop(double stiffness, AffineVector f, double c) {
    ContactProblem p;
    p.K = Matrix::diagonal(Vector::Constant(1, stiffness));
    p.B = Matrix::identity(1);
    p.c = Vector(Vector::Constant(1, c));
    p.f = std::move(f);
    return p;
}

void equilibria(Cases& cases, Index n) {
    const TimeGrid grid{0.1, 20};
    const auto is = [](double u) { return [u](double, double) { return Vector(Vector::Constant(1, u)); }; };
    const auto add = [&](const std::string& name, ContactProblem problem, Exact exact) {
        StabilityCase c{.group = "equilibrium", .name = name, .problem = std::move(problem), .grid = grid};
        c.exact = std::move(exact);
        c.error_limit = 1e-9;
        cases.push_back(std::move(c));
    };
    for (const double k : {1e-9, 1.0, 1e9}) {
        add("spring of " + power(k) + ", pressed", spring_on_stop(k, Vector(Vector::Constant(1, -k)), 0), is(0));
        add("spring of " + power(k) + ", pulled", spring_on_stop(k, Vector(Vector::Constant(1, 2 * k)), 0), is(2));
    }
    add("spring, load that jumps",
        spring_on_stop(1,
                       AffineVector(DenseMatrix(DenseMatrix::Ones(1, 1)),
                                    [](double t, Side side, VectorRef out) {
                                        out[0] = (side == Side::right ? t >= 1 : t > 1) ? 2 : -1;
                                    },
                                    {1.0}),
                       0),
        is(2));
    ContactProblem twice = spring_on_stop(1, Vector(Vector::Constant(1, -1.0)), 0);
    twice.B = Matrix(DenseMatrix(DenseMatrix::Ones(2, 1)));
    twice.c = Vector(Vector::Zero(2));
    add("spring, its row twice", std::move(twice), is(0));
    ContactProblem bar = bar_impact(n, {.velocity = 0, .gap = 0, .gravity = 10}).problem;
    bar.M.reset();
    bar.v0.resize(0);
    const Vector rest = standing(bar);
    bar.u0 = rest;
    add("floating bar pressed on the wall", bar, [rest](double, double) { return rest; });
    bar.B = Matrix::without_rows(bar.size());
    bar.c = Vector();
    // There is no equilibrium: any answer is wrong.
    add("floating bar under its weight, no wall", bar,
        [size = bar.size()](double, double) { return Vector(Vector::Constant(size, infinity)); });
    for (const InitialPenetration initial :
         {InitialPenetration::reject, InitialPenetration::project, InitialPenetration::accept}) {
        ContactProblem spring = spring_on_stop(1, Vector(Vector::Constant(1, -1.0)), 0);
        spring.u0 = Vector::Constant(1, -0.5);
        const bool rejected = initial == InitialPenetration::reject;
        add(std::string("spring, gap -0.5, ") + (rejected                                 ? "rejected"
                                                 : initial == InitialPenetration::project ? "projected"
                                                                                          : "accepted"),
            std::move(spring), is(0));
        cases.back().initial = initial;
        cases.back().rejected = rejected;
    }
}

}  // namespace

std::vector<StabilityCase> stability_cases(bool small) {
    const Index n = small ? 10 : 40;
    Cases cases;
    step_lengths(cases, n, small ? 600 : 4000);
    stiffnesses(cases, n);
    ratios(cases, n, small ? 5 : 10);
    gaps(cases, n);
    speeds(cases, n);
    persistent(cases, small ? 500 : 100'000);
    grazing(cases);
    dependent_rows(cases, n);
    floating(cases, n);
    load_jumps(cases);
    StabilityCase long_run{.group = "long run",
                           .name = small ? "bouncing bar, 3000 steps" : "bouncing bar, a million steps",
                           .problem = bouncing_bar(4).problem,
                           .grid = {0.01, small ? 3000 : 1'000'000}};
    long_run.fixed_steps = true;
    cases.push_back(std::move(long_run));
    equilibria(cases, n);
    return cases;
}

}  // namespace tact::bench
