// Nothing that is handed over has to outlive anything. These tests prove it where the preset with sanitizers builds them; without,
// they see that what was kept is right.
#include <gtest/gtest.h>

#include <array>

#include "../../contact/dense/dense_contact.hpp"
#include "../../lib/scenes/membrane.hpp"
#include "../../lib/sparse/cholmod_solver.hpp"
#include "../../rom/error/static_error_bound.hpp"
#include "../../rom/greedy/greedy.hpp"
#include "../../rom/greedy/sampling.hpp"
#include "../../rom/greedy/training_error.hpp"
#include "../../rom/model/online.hpp"
#include "../../tact.hpp"

namespace tact {
namespace {

/// Three masses on springs over a floor. Load and gap vary in time, and their functions own memory, as a user's do.
ContactProblem masses(bool lumped = true) {
    ContactProblem p;
    p.M = lumped ? Matrix::identity(3) : Matrix(DenseMatrix{{2, .5, 0}, {.5, 2, .5}, {0, .5, 2}});
    p.D = Matrix(DenseMatrix(0.01 * DenseMatrix::Identity(3, 3)));
    p.K = Matrix(DenseMatrix{{2, -1, 0}, {-1, 2, -1}, {0, -1, 2}});
    p.B = Matrix(DenseMatrix{{0, 1, 0}});
    const auto table = std::make_shared<std::vector<double>>(64, -1.0);
    p.c = {
        DenseMatrix{{-0.2}}, [table](double t, Side, VectorRef out) { out[0] = 1 + 0.1 * t * (*table)[0]; }, {0.5}};
    p.f = {DenseMatrix{{-1}, {-1}, {-1}}, [table](double, Side, VectorRef out) { out[0] = -(*table)[63]; }, {0.75}};
    p.u0 = p.v0 = Vector::Zero(3);
    return p;
}

ContactProblem hardening() {
    ContactProblem p = masses();
    const auto scale = std::make_shared<double>(0.5);
    p.r =
        InternalForce{[scale](const ConstVectorRef& u, VectorRef out) { out = *scale * u.array().cube(); },
                      [scale](const ConstVectorRef& u) { return Matrix::diagonal(3 * *scale * u.array().square()); },
                      [scale](const ConstVectorRef& u) { return *scale * u.array().pow(4).sum() / 4; }};
    return p;
}

ContactWorkspace workspace() { return ContactWorkspace(DenseContact()); }

std::vector<std::string> methods() {
    std::vector<std::string> all = registry().integrators();
    std::erase(all, "quasi-static");
    for (const char* text : {"trapezoid:rho=0.5,e=0.5", "bdf2-without-jump:e=0.5", "ida:e=0.5", "sdirk2:rtol=1e-4",
                             "tr-bdf2:e=0", "esdirk32:rtol=1e-4,e=0"})
        all.emplace_back(text);
    return all;
}

TEST(Lifetimes, ARunOwnsItsProblemAndItsWorkspace) {
    const TimeGrid grid{0.05, 20};
    for (const std::string& text : methods())
        for (const bool lumped : {true, false}) {
            const auto run = registry().integrator(text)->start(masses(lumped), grid, workspace());
            const ContactProblem kept = masses(lumped);
            const MarchReport expected = integrate(*registry().integrator(text), kept, grid, workspace());
            ASSERT_EQ(expected.outcome, Outcome::converged) << text;
            while (run->state().t < 1) ASSERT_EQ(run->advance().outcome, Outcome::converged) << text;
            EXPECT_TRUE(run->state().y == expected.final_state.y) << text;
            State between = run->state();
            try {
                run->dense(run->state().t, between);
            } catch (const InputError&) {  // without dense output
            }
            (void)run->warning();
        }
}

TEST(Lifetimes, ARunOwnsInternalForces) {
    for (const char* text : {"trapezoid", "bdf2", "bdf2-without-jump", "ida", "sdirk2"}) {
        const auto run = registry().integrator(text)->start(hardening(), {0.05, 20}, workspace());
        while (run->state().t < 1) ASSERT_EQ(run->advance().outcome, Outcome::converged) << text;
    }
}

TEST(Lifetimes, StageSolversAndObserversOwnTheirProblem) {
    StageSolver stages(masses(), workspace());
    State state(masses());
    const Vector zero = Vector::Zero(3);
    EXPECT_EQ(stages.solve(Stage{0.1, 10, zero, zero}, state).outcome, Outcome::converged);

    const ContactProblem problem = masses();
    std::vector<Observer> observers;
    EnergyLedger energy(masses());
    const ImpactLedger impacts(masses());
    observers.push_back(energy.observer());
    observers.push_back(impacts.observer());
    observers.push_back(EnergyLedger(masses()).observer());  // whose ledger is gone
    observers.push_back(ImpactLedger(masses()).observer());
    observers.push_back(Trajectory(masses(), 20).observer());
    const EnergyLedger moved = std::move(energy);
    ASSERT_EQ(integrate(Trapezoid(), problem, {0.05, 20}, workspace(), observers).outcome, Outcome::converged);
    EXPECT_EQ(moved.history().size(), 21);
    EXPECT_GT(moved.history().back().external_work, 0);
}

TEST(Lifetimes, AWorkspaceIsAHandle) {
    const ContactProblem problem = masses();
    std::shared_ptr<PreparedContact> prepared;
    {
        const ContactWorkspace first = workspace();
        const ContactWorkspace copy = first;
        prepared = first.prepared(problem, {1, 0, 0});
        EXPECT_EQ(copy.prepared(problem, {1, 0, 0}), prepared);
    }
    Vector u = Vector::Zero(3), lambda = Vector::Zero(1);
    EXPECT_EQ(prepared->solve(Vector::Ones(3), Vector::Zero(1), {u, lambda}).outcome, Outcome::converged);
}

TrainingResult trained_in_a_function() {
    const MembraneFamily family(12);
    TrainingOptions options;
    options.candidates = tensor_grid(family.lower(), family.upper(), {3, 3}, GridKind::cell_centred);
    options.max_iterations = 3;
    return train(family, {}, {std::make_shared<AutomaticContact>(), std::make_shared<DenseContact>()}, options);
}

TEST(Lifetimes, AReducedFamilyOwnsTheFullOne) {
    const TrainingResult result = trained_in_a_function();
    ASSERT_EQ(result.outcome, Outcome::converged);
    const Parameter gamma = Eigen::Vector2d(.4, .4);
    const ContactProblem found = result.reduced->at(gamma);
    const ContactProblem expected = reduce(MembraneFamily(12).at(gamma), result.basis);
    EXPECT_NEAR((found.c.at(0) - expected.c.at(0)).norm(), 0, 1e-14 * expected.c.at(0).norm());

    const std::unique_ptr<ContactFamily> reduced = reduce(MembraneFamily(12), result.basis);
    EXPECT_TRUE(reduced->at(gamma).c.at(0) == found.c.at(0));
    const StaticErrorBound bound(MembraneFamily(12), result.basis, CholmodSolver(), workspace());
    const StaticSolution solution = solve_static(found, workspace());
    EXPECT_GE(bound(gamma, solution.u, solution.lambda).error, 0);
    TrainingError error(MembraneFamily(12), {}, {std::make_shared<DenseContact>(), std::make_shared<DenseContact>()},
                        {gamma});
    EXPECT_GE(error(result.basis.U, {0, 1}), 0);
}

TEST(Lifetimes, AnOnlineModelOwnsAllItNeeds) {
    const auto make = [] {
        const TrainingResult result = trained_in_a_function();
        const auto model = std::make_shared<ReducedModel>(build_reduced_model(MembraneFamily(12), result.basis, {}));
        const Registry here = registry();
        return std::make_unique<Online>(model, online_method(*model, here));
    };
    const std::unique_ptr<Online> online = make();
    const Answer one = online->query(Eigen::Vector2d(.3, .6));
    EXPECT_EQ(one.outcome, Outcome::converged);
    const std::array<Parameter, 2> two{Eigen::Vector2d(.3, .6), Eigen::Vector2d(.5, .5)};
    EXPECT_TRUE(online->solve_many(two, 2).front().state.y == one.state.y);
}

TEST(Lifetimes, AMarchOwnsWhatItHolds) {
    const March all = march(masses(), Scheme{Trapezoid(), TimeGrid{0.05, 20}});
    EXPECT_EQ(all.u.rows(), 21);
    const March named = march(masses(), Scheme::named(std::string("trapezoid"), TimeGrid{0.05, 20}));
    EXPECT_TRUE(all.u == named.u);
}

TEST(Shared, TakesValuesAndPointersAndRefusesHalfAnObject) {
    struct Base {
        virtual ~Base() = default;
        virtual int number() const { return 1; }
    };
    struct Derived : Base {
        int number() const override { return 2; }
    };
    const Derived derived;
    const Base& known = derived;
    EXPECT_EQ(Shared<Base>(Base())->number(), 1);
    EXPECT_EQ(Shared<Base>(derived)->number(), 2);
    EXPECT_EQ(Shared<Base>(std::make_shared<Derived>())->number(), 2);
    EXPECT_EQ(Shared<Base>(std::make_unique<Derived>())->number(), 2);
    EXPECT_THROW(Shared<Base>{known}, InputError);
    EXPECT_EQ(Shared<Base>::borrowed(derived).get(), &derived);
    EXPECT_FALSE(Shared<Base>());
    EXPECT_FALSE(Shared<Base>(nullptr));
    EXPECT_THROW(ContactWorkspace(nullptr), InputError);
}

}  // namespace
}  // namespace tact
