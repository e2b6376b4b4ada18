#include "../../../rom/model/online.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "../../../contact/dense/dense_contact.hpp"
#include "../../../integrators/sundials/bdf2.hpp"
#include "../../../integrators/trapezoid.hpp"
#include "../../../lib/scenes/membrane.hpp"
#include "../../../rom/greedy/greedy.hpp"
#include "../../../rom/greedy/sampling.hpp"
#include "../chain.hpp"

namespace tact {
namespace {

constexpr Index nodes = 16;

QuantityOfInterest displacement(Index node) {
    QuantityOfInterest quantity{"u", Vector::Zero(nodes * nodes), {}};
    quantity.displacement[node] = 1;
    return quantity;
}

struct Trained {
    MembraneFamily family;
    ReducedBasis basis;
    ReducedModelOptions options;
    explicit Trained(Motion motion) : family(nodes, motion) {
        TrainingOptions training;
        training.max_iterations = 4;
        training.candidates = tensor_grid(family.lower(), family.upper(), {4, 3});
        training.sizes = [](int) { return BasisSizes{12, 8}; };
        TrainingMethod method;
        if (motion == Motion::dynamic) {
            method = {std::make_shared<Bdf2>(), TimeGrid::until(1.5, 0.01)};
            options.method = {Bdf2().name(), method.grid};
        }
        basis = train(family, method, {std::make_shared<DenseContact>(), std::make_shared<DenseContact>()}, training)
                    .basis;
        options.quantities = {displacement(120), {"force", {}, Vector::Ones(nodes * nodes)}};
        options.check_rows = {100, 120, 135};
        options.check_unknowns = {50, 120};
    }
    std::shared_ptr<const ReducedModel> model() const {
        return std::make_shared<ReducedModel>(build_reduced_model(family, basis, options));
    }
};

const Trained& still() {
    static const Trained trained(Motion::none);
    return trained;
}
const Trained& moving() {
    static const Trained trained(Motion::dynamic);
    return trained;
}

OnlineMethod method(const ReducedModel& model) {
    OnlineMethod made{std::make_shared<DenseContact>(), nullptr};
    if (!model.data().method.integrator.empty()) made.integrator = std::make_shared<Bdf2>();
    return made;
}

void expect_same_bits(const Answer& a, const Answer& b) {
    EXPECT_EQ(a.outcome, b.outcome);
    EXPECT_EQ(a.state.y, b.state.y);
    EXPECT_EQ(a.state.lambda, b.state.lambda);
    EXPECT_EQ(a.quantities, b.quantities);
    EXPECT_EQ(a.trust.penetration, b.trust.penetration);
    EXPECT_EQ(a.trust.residual, b.trust.residual);
    EXPECT_EQ(a.kkt.largest(), b.kkt.largest());
}

TEST(Online, GivesTheSameBitsForAnyNumberOfThreadsAndAnyOrder) {
    for (const Trained* trained : {&still(), &moving()}) {
        const auto model = trained->model();
        Online online(model, method(*model));
        std::vector<Parameter> gammas = spread_points(model->lower(), model->upper(), 23);
        const auto one = online.solve_many(gammas, 1);
        for (const int threads : {2, 5}) {
            const auto many = online.solve_many(gammas, threads);
            for (std::size_t k = 0; k < gammas.size(); ++k) expect_same_bits(one[k], many[k]);
        }
        for (std::size_t k = gammas.size(); k-- > 0;) expect_same_bits(one[k], online.query(gammas[k]));
    }
}

TEST(Online, ReadsQuantitiesOffAsTheLiftedStatesHaveThem) {
    for (const Trained* trained : {&still(), &moving()}) {
        const auto model = trained->model();
        OnlineOptions options;
        options.keep_states = true;
        options.stride = 7;
        Online online(model, method(*model), options);
        const Answer answer = online.query(Eigen::Vector2d(0.5, 0.6));
        ASSERT_EQ(answer.outcome, Outcome::converged);
        const Index times = static_cast<Index>(answer.times.size());
        EXPECT_EQ(times, model->data().method.integrator.empty() ? 1 : 150 / 7 + 2);
        ASSERT_EQ(answer.quantities.cols(), times);
        double force = 0;
        for (Index j = 0; j < times; ++j) {
            const Vector u = lift(trained->basis, answer.q.col(j));
            const Vector lambda = lift_multipliers(trained->basis, answer.s.col(j));
            EXPECT_NEAR(answer.quantities(0, j), u[120], 1e-13);
            EXPECT_NEAR(answer.quantities(1, j), lambda.sum(), 1e-12 * (1 + lambda.sum()));
            force = std::max(force, lambda.sum());
        }
        EXPECT_GT(force, 0);
    }
}

TEST(Online, ChecksPenetrationAndResidualAsTheFullProblemHasThem) {
    const auto model = still().model();
    Online online(model, method(*model));
    const Parameter gamma = Eigen::Vector2d(0.52, 0.31);
    const Answer answer = online.query(gamma);
    const ContactProblem full = still().family.at(gamma);
    const ReducedBasis& basis = still().basis;
    const Vector u = basis.U * answer.state.u(), lambda = basis.U_lambda * answer.state.lambda;
    const Vector gap = full.B * u - full.c.at(0), residual = full.K * u - full.f.at(0) - lambda;
    double penetration = 0;
    for (const Index row : still().options.check_rows) penetration += std::pow(std::min(gap[row], 0.0), 2);
    EXPECT_NEAR(answer.trust.penetration, std::sqrt(penetration) / answer.state.u().norm(), 1e-10);
    EXPECT_NEAR(answer.trust.residual, std::hypot(residual[50], residual[120]) / answer.state.u().norm(), 1e-12);
}

TEST(Online, ResidualOfAMarchIsThatOfItsStage) {
    // With the full space as basis every balance holds.
    const ContactProblem full = testing::chain(24, -0.1, {.damping = true});
    ReducedModelOptions options;
    options.method = {Trapezoid().name(), TimeGrid::until(6, 0.05)};
    options.check_unknowns = {3, 4, 17};
    options.check_rows = {2, 5};
    options.check_stride = 1;
    const auto model = std::make_shared<ReducedModel>(
        build_reduced_model(SingleProblem(full), {testing::identity(24), testing::identity(12)}, options));
    Online online(model, {std::make_shared<DenseContact>(), std::make_shared<Trapezoid>()});
    const Answer answer = online.query({});
    ASSERT_EQ(answer.outcome, Outcome::converged);
    EXPECT_LT(answer.trust.residual, 1e-12);
    EXPECT_LT(answer.trust.penetration, 1e-12);
}

TEST(Online, FlagsWhatIsOutsideTheBox) {
    const auto model = still().model();
    Online online(model, method(*model));
    EXPECT_FALSE(online.query(Eigen::Vector2d(0.45, 0.4)).trust.doubtful);
    EXPECT_FALSE(online.query(model->upper()).trust.outside_box);
    const Answer outside = online.query(Eigen::Vector2d(0.61, 0.4));
    EXPECT_TRUE(outside.trust.outside_box);
    EXPECT_TRUE(outside.trust.doubtful);
    EXPECT_FALSE(outside.full);
}

TEST(Online, FallsBackToTheFullModelWhereItIsInDoubt) {
    for (const Trained* trained : {&still(), &moving()}) {
        const auto model = trained->model();
        OnlineOptions options;
        options.fall_back = FullModel{std::make_shared<MembraneFamily>(trained->family),
                                      std::make_shared<DenseContact>(), trained->options.quantities};
        Online online(model, method(*model), options);
        const std::vector<Parameter> gammas{Eigen::Vector2d(0.45, 0.4), Eigen::Vector2d(0.62, 0.4)};
        const auto answers = online.solve_many(gammas, 2);
        EXPECT_FALSE(answers[0].full);
        ASSERT_TRUE(answers[1].full);
        EXPECT_EQ(answers[1].outcome, Outcome::converged);
        ContactWorkspace workspace(std::make_shared<DenseContact>());
        const ContactProblem full = trained->family.at(gammas[1]);
        const Vector expected =
            model->data().method.integrator.empty()
                ? solve_static(full, workspace).u
                : Vector(integrate(Bdf2(), full, model->data().method.grid, workspace).final_state.u());
        EXPECT_LT((answers[1].full->u() - expected).norm(), 1e-11);
        EXPECT_EQ(answers[1].quantities(0, answers[1].quantities.cols() - 1), answers[1].full->u()[120]);
        EXPECT_EQ(answers[1].quantities.cols(), answers[0].quantities.cols());
    }
}

TEST(Online, AnswersThatFailSayWhyAndStopNoOther) {
    const auto data = build_reduced_model(still().family, still().basis, still().options);
    ExactFunctions exact;
    exact.gap = [](const Parameter& gamma, std::span<const Index> rows, VectorRef out) {
        if (gamma[0] > 0.5) throw InputError("the obstacle is not known here");
        still().family.gap(gamma, rows, out);
    };
    const auto model = std::make_shared<ReducedModel>(data, exact);
    Online online(model, method(*model));
    const std::vector<Parameter> gammas{Eigen::Vector2d(0.45, 0.4), Eigen::Vector2d(0.55, 0.4)};
    const auto answers = online.solve_many(gammas, 2);
    EXPECT_EQ(answers[0].outcome, Outcome::converged);
    EXPECT_EQ(answers[1].outcome, Outcome::inaccurate);
    EXPECT_EQ(answers[1].failure, "the obstacle is not known here");
}

TEST(Online, RefusesWhatDoesNotFit) {
    const auto model = moving().model();
    EXPECT_THROW(Online(model, {std::make_shared<DenseContact>(), nullptr}), InputError);
    EXPECT_THROW(Online(model, {std::make_shared<DenseContact>(), std::make_shared<Trapezoid>()}), InputError);
    EXPECT_THROW(Online(model, {nullptr, std::make_shared<Bdf2>()}), InputError);
    EXPECT_THROW(Online(nullptr, method(*model)), InputError);
    Online online(model, method(*model));
    EXPECT_THROW((void)online.query(Vector::Zero(3)), InputError);
    EXPECT_THROW((void)online.solve_many({}, 0), InputError);
    const std::vector<Parameter> gammas{model->lower(), Vector::Constant(2, infinity)};
    EXPECT_THROW((void)online.solve_many(gammas, 1), InputError);
}

}  // namespace
}  // namespace tact
