#include "../../../rom/error/static_error_bound.hpp"

#include <gtest/gtest.h>

#include <optional>
#include <random>

#include "../../../contact/automatic.hpp"
#include "../../../contact/dense/dense_contact.hpp"
#include "../../../lib/scenes/membrane.hpp"
#include "../../../lib/sparse/cholmod_solver.hpp"
#include "../../../rom/greedy/greedy.hpp"
#include "../../../rom/greedy/sampling.hpp"
#include "../../../rom/model/chebyshev_series.hpp"
#include "../../../rom/model/reduce.hpp"

namespace tact {
namespace {

double energy_norm(const Matrix& K, const Vector& x) { return std::sqrt(std::max(0.0, x.dot(K * x))); }

TEST(StaticErrorBound, IsAboveTheErrorOfTheFullSolutionAtHundredsOfParameters) {
    const MembraneFamily family(24);
    for (const int samples : {3, 10}) {
        TrainingOptions options;
        options.max_iterations = samples;
        options.candidates = tensor_grid(family.lower(), family.upper(), {6, 5});
        const TrainingResult trained =
            train(family, {}, {std::make_shared<AutomaticContact>(), std::make_shared<DenseContact>()}, options);
        ContactWorkspace contact(std::make_shared<AutomaticContact>()), reduced(std::make_shared<DenseContact>());
        const StaticErrorBound bound(family, trained.basis, CholmodSolver(), contact);
        std::vector<double> effectivity;
        for (const Parameter& gamma : spread_points(family.lower(), family.upper(), 150)) {
            const ContactProblem full = family.at(gamma);
            const StaticSolution u = solve_static(full, contact);
            const StaticSolution q = solve_static(trained.reduced->at(gamma), reduced);
            const double error = energy_norm(full.K, u.u - trained.basis.U * q.u);
            const EnergyBound at = bound(gamma, q.u, q.lambda);
            EXPECT_GE(at.error, error);
            EXPECT_LE(at.error, at.residual + at.correction + std::sqrt(at.gap));
            effectivity.push_back(at.error / error);
        }
        std::sort(effectivity.begin(), effectivity.end());
        EXPECT_LT(effectivity[75], 20);
    }
}

/// The stage of an implicit step is a static problem with its A for K: here of backward Euler, from rest.
class StageFamily final : public ContactFamily {
public:
    explicit StageFamily(Index n) : family_(n, Motion::dynamic) {}
    std::vector<std::string> names() const override { return family_.names(); }
    Parameter lower() const override { return family_.lower(); }
    Parameter upper() const override { return family_.upper(); }
    ContactProblem at(const Parameter& gamma) const override {
        ContactProblem stage = family_.at(gamma);
        if (!A_) A_ = combined(stage, {1 / (dt * dt), 1 / dt, 1});
        const Vector start = Vector::Constant(stage.size(), -0.5);
        stage.f = Vector(stage.f.at(0) + *stage.M * start / (dt * dt));
        stage.K = *A_;
        stage.M.reset();
        return stage;
    }
    void gap(const Parameter& gamma, std::span<const Index> rows, VectorRef out) const override {
        family_.gap(gamma, rows, out);
    }

private:
    static constexpr double dt = 0.2;
    MembraneFamily family_;
    mutable std::optional<Matrix> A_;
};

TEST(StaticErrorBound, IsAboveTheErrorOfAStage) {
    const StageFamily family(20);
    TrainingOptions options;
    options.max_iterations = 5;
    options.candidates = tensor_grid(family.lower(), family.upper(), {6, 5});
    const TrainingResult trained =
        train(family, {}, {std::make_shared<AutomaticContact>(), std::make_shared<DenseContact>()}, options);
    ContactWorkspace contact(std::make_shared<AutomaticContact>()), reduced(std::make_shared<DenseContact>());
    const StaticErrorBound bound(family, trained.basis, CholmodSolver(), contact);
    int contacts = 0;
    for (const Parameter& gamma : spread_points(family.lower(), family.upper(), 40)) {
        const ContactProblem full = family.at(gamma);
        const StaticSolution u = solve_static(full, contact), q = solve_static(trained.reduced->at(gamma), reduced);
        contacts += u.report.active > 0;
        EXPECT_GE(bound(gamma, q.u, q.lambda).error, energy_norm(full.K, u.u - trained.basis.U * q.u));
    }
    EXPECT_GT(contacts, 10);
}

/// Random programmes: no structure, any sign in B, a load that presses some rows.
class RandomFamily final : public ContactFamily {
public:
    RandomFamily(unsigned seed, Index n, Index m) : random_(seed) {
        const DenseMatrix X = numbers(n, n);
        problem_.K = Matrix(DenseMatrix(X * X.transpose() + 0.1 * DenseMatrix::Identity(n, n)));
        problem_.B = Matrix(numbers(m, n));
        problem_.f = Vector(numbers(n, 1));
        problem_.c = Vector(numbers(m, 1));
        slope_ = numbers(m, 1);
    }
    DenseMatrix numbers(Index rows, Index cols) {
        std::normal_distribution<double> normal;
        return DenseMatrix::NullaryExpr(rows, cols, [&] { return normal(random_); });
    }
    std::vector<std::string> names() const override { return {"gamma"}; }
    Parameter lower() const override { return Vector::Constant(1, -1); }
    Parameter upper() const override { return Vector::Ones(1); }
    ContactProblem at(const Parameter& gamma) const override {
        ContactProblem problem = problem_;
        problem.c.modes += gamma[0] * slope_;
        return problem;
    }
    void gap(const Parameter& gamma, std::span<const Index> rows, VectorRef out) const override {
        for (std::size_t k = 0; k < rows.size(); ++k)
            out[static_cast<Index>(k)] = problem_.c.modes(rows[k], 0) + gamma[0] * slope_[rows[k]];
    }

private:
    std::mt19937 random_;
    ContactProblem problem_;
    Vector slope_;
};

TEST(StaticErrorBound, IsAboveTheErrorOnRandomProgrammesForAnyMultipliersAndStates) {
    int contacts = 0, finite = 0, total = 0;
    for (unsigned seed = 1; seed <= 60; ++seed) {
        RandomFamily family(seed, 12, 7);
        const ReducedBasis basis{family.numbers(12, 5), family.numbers(7, 3).cwiseAbs()};
        ContactWorkspace contact(std::make_shared<DenseContact>());
        const StaticErrorBound bound(family, basis, DenseLinearSolver(), contact);
        const auto reduced = reduce(family, basis);
        for (const double at : {-1.0, -0.3, 0.4, 0.9}) {
            const Parameter gamma = Vector::Constant(1, at);
            const ContactProblem full = family.at(gamma);
            const StaticSolution u = solve_static(full, contact);
            ASSERT_EQ(u.report.outcome, Outcome::converged);
            contacts += u.report.active > 0;
            const StaticSolution q = solve_static(reduced->at(gamma), contact);
            std::vector<std::pair<Vector, Vector>> answers{{family.numbers(5, 1), family.numbers(3, 1).cwiseAbs()}};
            if (q.report.outcome == Outcome::converged) answers.emplace_back(q.u, q.lambda);
            for (const auto& [state, multipliers] : answers) {
                const double found = bound(gamma, state, multipliers).error;
                EXPECT_GE(found * (1 + 1e-10), energy_norm(full.K, u.u - basis.U * state));
                finite += found < infinity;
                ++total;
            }
        }
    }
    EXPECT_GT(contacts, 200);
    EXPECT_GT(finite, total * 9 / 10);
}

/// Rows that are off at some parameters: row k where floor(gamma) = k modulo 3.
class SwitchedFamily final : public ContactFamily {
public:
    explicit SwitchedFamily(RandomFamily family) : family_(std::move(family)) {}
    std::vector<std::string> names() const override { return {"gamma"}; }
    Parameter lower() const override { return Vector::Zero(1); }
    Parameter upper() const override { return Vector::Constant(1, 3); }
    ContactProblem at(const Parameter& gamma) const override {
        ContactProblem problem = family_.at(gamma / 3);
        for (Index row = 0; row < problem.constraints(); ++row)
            if (off(gamma, row)) problem.c.modes(row, 0) = -infinity;
        return problem;
    }
    void gap(const Parameter& gamma, std::span<const Index> rows, VectorRef out) const override {
        family_.gap(gamma / 3, rows, out);
        for (std::size_t k = 0; k < rows.size(); ++k)
            if (off(gamma, rows[k])) out[static_cast<Index>(k)] = -infinity;
    }
    static bool off(const Parameter& gamma, Index row) { return static_cast<Index>(gamma[0]) == row % 3; }

private:
    RandomFamily family_;
};

TEST(StaticErrorBound, StaysABoundWhereRowsThatMultipliersTouchAreSwitchedOff) {
    int finite = 0, without = 0;
    for (unsigned seed = 1; seed <= 30; ++seed) {
        RandomFamily random(seed, 12, 7);
        const DenseMatrix U = random.numbers(12, 5);
        for (const bool single : {true, false}) {
            const DenseMatrix U_lambda =
                single ? DenseMatrix::Identity(7, 7) : DenseMatrix(random.numbers(7, 4).cwiseMax(0));
            const Vector q = random.numbers(5, 1), all = random.numbers(U_lambda.cols(), 1).cwiseAbs();
            const SwitchedFamily family(random);
            ContactWorkspace contact(std::make_shared<DenseContact>());
            const StaticErrorBound bound(family, {U, U_lambda}, DenseLinearSolver(), contact);
            for (const double at : {0.5, 1.5, 2.5}) {
                const Parameter gamma = Vector::Constant(1, at);
                const ContactProblem full = family.at(gamma);
                const StaticSolution u = solve_static(full, contact);
                ASSERT_EQ(u.report.outcome, Outcome::converged);
                Vector allowed = all;  // no multiplier on a row that is off
                for (Index row = 0; row < 7; ++row)
                    for (Index j = 0; j < allowed.size(); ++j)
                        if (SwitchedFamily::off(gamma, row) && U_lambda(row, j) > 0) allowed[j] = 0;
                for (const Vector& s : {allowed, all, Vector(Vector::Zero(all.size()))}) {
                    const double found = bound(gamma, q, s).error;
                    EXPECT_GE(found * (1 + 1e-10), energy_norm(full.K, u.u - U * q));
                    finite += found < infinity;
                    if (s == all && all != allowed) {
                        EXPECT_EQ(found, infinity);
                        ++without;
                    }
                }
            }
        }
    }
    EXPECT_GT(finite, 300);
    EXPECT_GT(without, 150);
}

TEST(StaticErrorBound, IsTheErrorWhereNothingTouches) {
    RandomFamily family(7, 12, 7);
    const ContactProblem full = family.at(Vector::Zero(1));
    class Low final : public ContactFamily {
    public:
        explicit Low(ContactProblem problem) : problem_(std::move(problem)) { problem_.c.modes.array() -= 1000; }
        std::vector<std::string> names() const override { return {}; }
        Parameter lower() const override { return {}; }
        Parameter upper() const override { return {}; }
        ContactProblem at(const Parameter&) const override { return problem_; }
        void gap(const Parameter&, std::span<const Index> rows, VectorRef out) const override {
            for (std::size_t k = 0; k < rows.size(); ++k) out[static_cast<Index>(k)] = problem_.c.modes(rows[k], 0);
        }

    private:
        ContactProblem problem_;
    };
    const Low low(full);
    const ReducedBasis basis{family.numbers(12, 5), family.numbers(7, 3).cwiseAbs()};
    ContactWorkspace contact(std::make_shared<DenseContact>());
    const StaticErrorBound bound(low, basis, DenseLinearSolver(), contact);
    const Vector q = solve_static(reduce(low.at({}), basis), contact).u;
    const double error = energy_norm(full.K, solve_static(low.at({}), contact).u - basis.U * q);
    EXPECT_NEAR(bound({}, q, Vector::Zero(3)).error, error, 1e-10 * error);
}

TEST(StaticErrorBound, RefusesWhatItCannotBound) {
    const MembraneFamily moving(5, Motion::dynamic), still(5);
    const ReducedBasis basis{DenseMatrix::Ones(25, 1), DenseMatrix::Ones(25, 1)};
    ContactWorkspace contact(std::make_shared<AutomaticContact>());
    EXPECT_THROW(StaticErrorBound(moving, basis, CholmodSolver(), contact), InputError);
    const StaticErrorBound bound(still, basis, CholmodSolver(), contact);
    EXPECT_THROW((void)bound(still.lower(), Vector::Zero(2), Vector::Zero(1)), InputError);
    EXPECT_THROW((void)bound(still.lower(), Vector::Zero(1), Vector::Constant(1, -1)), InputError);
    const double nan = std::nan("");
    EXPECT_THROW((void)bound(still.lower(), Vector::Zero(1), Vector::Constant(1, nan)), InputError);
    EXPECT_THROW((void)bound(still.lower(), Vector::Constant(1, nan), Vector::Zero(1)), InputError);
}

}  // namespace
}  // namespace tact
