#include "../../../rom/model/reduced_model.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <Eigen/SVD>

#include "../../../contact/dense/dense_contact.hpp"
#include "../../../integrators/sundials/bdf2.hpp"
#include "../../../rom/greedy/greedy.hpp"
#include "../../../rom/greedy/sampling.hpp"
#include "../../../rom/model/build_reduced_model.hpp"
#include "../../../rom/model/reduce.hpp"
#include "../chain.hpp"

namespace tact {
namespace {

using testing::chain;
using testing::ChainFamily;
using testing::scattered;

constexpr Index n = 24, m = 12, p = 6, p_lambda = 4;

ReducedBasis some_basis(const ContactProblem& problem) {
    return modal_basis(problem, {scattered(n, p), scattered(m, p_lambda).cwiseAbs()});
}

/// Everything of a chain moves with gamma: stiffness, load, gap and the first state.
class ChangingFamily final : public ContactFamily {
public:
    std::vector<std::string> names() const override { return {"stiffness", "load"}; }
    std::vector<std::string> varying() const override { return {"K", "f", "c"}; }
    Parameter lower() const override { return Eigen::Vector2d(0.5, -1); }
    Parameter upper() const override { return Eigen::Vector2d(2, 1); }
    ContactProblem at(const Parameter& gamma) const override {
        ContactProblem problem = chain(n, -0.4, {.mass = false, .moving_load = false});
        DenseMatrix K = problem.K.to_dense();
        for (Index i = 0; i < n; ++i) K(i, i) += std::exp(-gamma[0] * static_cast<double>(i) / n);
        problem.K = Matrix(K);
        problem.f = Vector(problem.f.modes.col(0) * (1 + 0.3 * std::sin(gamma[1])));
        problem.c = Vector(problem.c.modes.col(0) * std::cosh(gamma[0] * gamma[1]));
        return problem;
    }
    void gap(const Parameter& gamma, std::span<const Index> rows, VectorRef out) const override {
        const ContactProblem problem = at(gamma);
        for (std::size_t k = 0; k < rows.size(); ++k) out[static_cast<Index>(k)] = problem.c.modes(rows[k], 0);
    }
};

TEST(ReducedModel, IsTheReducedFamilyWhereOnlyTheGapMoves) {
    const ChainFamily family(n, {.mass = false, .moving_load = false});
    const ReducedBasis basis = some_basis(family.at(family.lower()));
    const auto expected = reduce(family, basis);
    const ReducedModel model(build_reduced_model(family, basis));
    EXPECT_LT(model.data().parameter_error, 1e-9);
    EXPECT_TRUE(model.data().parts.empty());
    EXPECT_EQ(model.names(), family.names());
    const ContactProblem first = model.at(family.lower());
    for (const Parameter& gamma : spread_points(family.lower(), family.upper(), 30)) {
        const ContactProblem a = model.at(gamma), b = expected->at(gamma);
        EXPECT_LT((a.c.modes - b.c.modes).norm(), 1e-9 * b.c.modes.norm());
        EXPECT_TRUE(a.K.same_storage(first.K) && a.B.same_storage(first.B));
    }
}

TEST(ReducedModel, FindsAndInterpolatesEveryPartThatDependsOnTheParameters) {
    const ChangingFamily family;
    const ReducedBasis basis = some_basis(family.at(family.lower()));
    const ReducedModelData data = build_reduced_model(family, basis, {.samples = 60});
    EXPECT_EQ(data.parts, (std::vector<std::string>{"K", "f"}));
    EXPECT_LT(data.parameter_error, 1e-8);
    const ReducedModel model(data);
    for (const Parameter& gamma : spread_points(family.lower(), family.upper(), 20)) {
        const ContactProblem a = model.at(gamma), b = reduce(family.at(gamma), basis);
        EXPECT_LT((a.K.to_dense() - b.K.to_dense()).norm(), 1e-8 * b.K.to_dense().norm());
        EXPECT_LT((a.f.modes - b.f.modes).norm(), 1e-8 * b.f.modes.norm());
        EXPECT_LT((a.c.modes - b.c.modes).norm(), 1e-8 * b.c.modes.norm());
        EXPECT_LT((a.B.to_dense() - b.B.to_dense()).norm(), 1e-14);
    }
}

TEST(ReducedModel, IsTrainedOnAFamilyWhoseStiffnessAndLoadVary) {
    const ChangingFamily family;
    const auto solver = std::make_shared<DenseContact>();
    TrainingOptions options;
    options.max_iterations = 12;
    options.candidates = tensor_grid(family.lower(), family.upper(), {6, 6});
    options.weights.negativity = 1;
    EXPECT_THROW((void)train(family, {}, {solver, solver}, options), InputError);
    // The error itself: the stiffest penetrate nothing with one mode, so the indicator would be content with that.
    ContactWorkspace full(solver), reduced(solver, 1);
    options.oracle = [&](const Parameter& gamma, const ReducedBasis& basis, const ReducedStates& states) {
        return (basis.U * states.q.col(0) - solve_static(family.at(gamma), full).u).squaredNorm();
    };
    const TrainingResult trained = train(family, {}, {solver, solver}, options);
    ASSERT_EQ(trained.outcome, Outcome::converged);
    ReducedModelOptions few;
    few.samples = 60;
    const ReducedModel model(build_reduced_model(family, trained.basis, few));
    for (const Parameter& gamma : spread_points(family.lower(), family.upper(), 10)) {
        const StaticSolution u = solve_static(family.at(gamma), full), q = solve_static(model.at(gamma), reduced);
        ASSERT_EQ(q.report.outcome, Outcome::converged);
        EXPECT_LT((trained.basis.U * q.u - u.u).norm(), 0.02 * u.u.norm());
    }
}

/// Seven parameters: too many for series. K and f are affine in four functions of them.
class ManyParameters final : public ContactFamily {
public:
    explicit ManyParameters(bool told = true) : told_(told) {}
    std::vector<std::string> names() const override { return {"a", "b", "c", "d", "e", "f", "g"}; }
    Parameter lower() const override { return Vector::Constant(7, 0.2); }
    Parameter upper() const override { return Vector::Ones(7); }
    std::vector<std::string> varying() const override { return {"K", "f"}; }
    Vector coefficients(const Parameter& g) const override {
        if (!told_) return {};
        return Eigen::Vector4d(1, g[0] * std::sin(g[1]), std::exp(g[2] * g[3]), g.tail(3).squaredNorm());
    }
    ContactProblem at(const Parameter& gamma) const override {
        const Vector theta = ManyParameters().coefficients(gamma);
        ContactProblem problem = chain(n, -0.4, {.mass = false, .moving_load = false});
        const Vector ramp = Vector::LinSpaced(n, 0, theta[2]);
        problem.K = combine(1, problem.K, theta[1], Matrix::diagonal(ramp));
        problem.f = Vector(problem.f.modes.col(0) * theta[3] - ramp);
        return problem;
    }
    void gap(const Parameter& gamma, std::span<const Index> rows, VectorRef out) const override {
        const ContactProblem problem = at(gamma);
        for (std::size_t k = 0; k < rows.size(); ++k) out[static_cast<Index>(k)] = problem.c.modes(rows[k], 0);
    }

private:
    bool told_;
};

TEST(ReducedModel, FindsTheTermsOfCoefficientsThatTheFamilyTells) {
    // K needs the product of two of the four: not affine, which has to be noticed.
    const ManyParameters family;
    const ReducedBasis basis = some_basis(family.at(family.lower()));
    EXPECT_THROW((void)build_reduced_model(family, basis), InputError);
    class Affine final : public ContactFamily {
    public:
        std::vector<std::string> names() const override { return family_.names(); }
        Parameter lower() const override { return family_.lower(); }
        Parameter upper() const override { return family_.upper(); }
        std::vector<std::string> varying() const override { return family_.varying(); }
        Vector coefficients(const Parameter& g) const override {
            Vector theta(5);
            theta << family_.coefficients(g), 0;
            theta[4] = theta[1] * theta[2];
            return theta;
        }
        ContactProblem at(const Parameter& gamma) const override { return family_.at(gamma); }
        void gap(const Parameter& gamma, std::span<const Index> rows, VectorRef out) const override {
            family_.gap(gamma, rows, out);
        }

    private:
        ManyParameters family_;
    };
    const Affine affine;
    const ReducedModelData data = build_reduced_model(affine, basis);
    EXPECT_LT(data.parameter_error, 1e-10);
    const Parameter gamma = spread_points(affine.lower(), affine.upper(), 3).back();
    EXPECT_THROW((void)ReducedModel(data).at(gamma), InputError);
    const ReducedModel model(data, {{}, [&](const Parameter& at) { return affine.coefficients(at); }});
    const ContactProblem a = model.at(gamma), b = reduce(affine.at(gamma), basis);
    EXPECT_LT((a.K.to_dense() - b.K.to_dense()).norm(), 1e-10 * b.K.to_dense().norm());
    EXPECT_LT((a.f.modes - b.f.modes).norm(), 1e-10 * b.f.modes.norm());
    EXPECT_THROW((void)build_reduced_model(ManyParameters(false), basis), InputError);
}

TEST(ReducedModel, NoticesAFamilyThatDoesNotSayWhatVaries) {
    class Silent final : public ContactFamily {
    public:
        std::vector<std::string> names() const override { return family_.names(); }
        Parameter lower() const override { return family_.lower(); }
        Parameter upper() const override { return family_.upper(); }
        ContactProblem at(const Parameter& gamma) const override { return family_.at(gamma); }
        void gap(const Parameter& gamma, std::span<const Index> rows, VectorRef out) const override {
            family_.gap(gamma, rows, out);
        }

    private:
        ChangingFamily family_;
    };
    const Silent family;
    EXPECT_THROW((void)build_reduced_model(family, some_basis(family.at(family.lower()))), InputError);
}

TEST(ReducedModel, TakesTheGapFromAFunctionAtFewRows) {
    const ChainFamily family(120, {.mass = false, .moving_load = false});
    const ContactProblem first = family.at(family.lower());
    const ReducedBasis basis = modal_basis(first, {scattered(120, p), scattered(60, p_lambda).cwiseAbs()});
    ReducedModelOptions options;
    options.tolerance = 1e-6;
    options.series.max_points = 1;  // as in a box of many parameters
    const ReducedModelData data = build_reduced_model(family, basis, options);
    EXPECT_LT(data.gap_rows.size(), 20U);
    const Parameter gamma = Eigen::Vector2d(0.21, 0.44);
    EXPECT_THROW((void)ReducedModel(data).at(gamma), InputError);
    ExactFunctions exact;
    exact.gap = [&](const Parameter& at, std::span<const Index> rows, VectorRef out) { family.gap(at, rows, out); };
    const ReducedModel model(data, exact);
    const Vector expected = reduce(family, basis)->at(gamma).c.modes.col(0);
    EXPECT_LT((model.at(gamma).c.modes.col(0) - expected).norm(), 1e-5 * expected.norm());
    EXPECT_GT((model.at(gamma).c.modes.col(0) - expected).norm(), 0);
}

TEST(ReducedModel, MarchesWithTablesAsWithFunctionsOfTime) {
    const ContactProblem full = chain(n, -0.02);
    const ReducedBasis basis = some_basis(full);
    const TimeGrid grid = TimeGrid::until(6, 0.05);
    ReducedModelOptions options;
    options.method.grid = grid;
    const ReducedModel model(build_reduced_model(SingleProblem(full), basis, options));
    ContactWorkspace contact(std::make_shared<DenseContact>());
    const MarchReport a = integrate(Bdf2(), model.at({}), grid, contact);
    const MarchReport b = integrate(Bdf2(), reduce(full, basis), grid, contact);
    ASSERT_EQ(a.outcome, Outcome::converged);
    EXPECT_GT(a.most_active, 0);
    EXPECT_EQ(a.final_state.y, b.final_state.y);
    EXPECT_EQ(model.at({}).f.jumps, full.f.jumps);
}

TEST(ReducedModel, KnowsItsBox) {
    const ChainFamily family(n, {.mass = false, .moving_load = false});
    const ReducedModel model(build_reduced_model(family, some_basis(family.at(family.lower()))));
    EXPECT_TRUE(model.covers(family.lower()));
    EXPECT_TRUE(model.covers(family.upper()));
    EXPECT_FALSE(model.covers(Eigen::Vector2d(0.1, 0.81)));
    EXPECT_THROW((void)model.at(Vector::Zero(3)), InputError);
    EXPECT_THROW((void)model.at(Vector::Constant(2, infinity)), InputError);
}

TEST(ReducedModel, RefusesDataThatDoNotFit) {
    const ChainFamily family(n, {.mass = false, .moving_load = false});
    const ReducedModelData data = build_reduced_model(family, some_basis(family.at(family.lower())));
    ReducedModelData broken = data;
    broken.gap.terms = scattered(p_lambda + 1, data.gap.terms.cols());
    EXPECT_THROW(ReducedModel{broken}, InputError);
    broken = data;
    broken.gap_rows.pop_back();
    EXPECT_THROW(ReducedModel{broken}, InputError);
    broken = data;
    broken.parts = {"D"};
    EXPECT_THROW(ReducedModel{broken}, InputError);
    broken = data;
    broken.gap.theta.counts.push_back(1);
    EXPECT_THROW(ReducedModel{broken}, InputError);
    broken = data;
    broken.gap.theta.counts = {-1, -data.gap.theta.coefficients.cols()};
    EXPECT_THROW(ReducedModel{broken}, InputError);
    broken = data;
    broken.gap.theta.lower.resize(1);
    EXPECT_THROW(ReducedModel{broken}, InputError);
    broken = data;
    broken.load = {TimeGrid{0, 1, 0}, DenseMatrix::Ones(1, 2), DenseMatrix::Ones(1, 2), {}};
    EXPECT_THROW(ReducedModel{broken}, InputError);
    broken.load = {TimeGrid{0.1, 1, 0}, DenseMatrix::Ones(1, 2), DenseMatrix::Ones(1, 3), {}};
    EXPECT_THROW(ReducedModel{broken}, InputError);
}

TEST(TimeTable, IsExactOnItsGridOnBothSidesOfAJumpAndLinearBetween) {
    const AffineVector load(DenseMatrix::Identity(2, 2),
                            [](double t, Side side, VectorRef out) {
                                out[0] = 3 * t;
                                out[1] = t > 1 || (t == 1 && side == Side::right) ? 5 : 2;
                            },
                            {1.0});
    const TimeTable table = tabulate(load, TimeGrid::until(2, 0.25));
    Vector value(2);
    table.evaluate(1, Side::left, value);
    EXPECT_EQ(value, Eigen::Vector2d(3, 2));
    table.evaluate(1, Side::right, value);
    EXPECT_EQ(value, Eigen::Vector2d(3, 5));
    table.evaluate(0.9, Side::right, value);
    EXPECT_NEAR(value[0], 2.7, 1e-15);
    EXPECT_EQ(value[1], 2);
    AffineVector off = load;
    off.jumps = {0.9};
    EXPECT_THROW((void)tabulate(off, TimeGrid::until(2, 0.25)), InputError);
    EXPECT_FALSE(tabulate(off, TimeGrid::until(2, 0.25), 5).empty());
}

TEST(BasisReport, SeesDependentRows) {
    const ContactProblem full = chain(n, -0.4, {.mass = false, .moving_load = false});
    ReducedBasis basis = some_basis(full);
    const BasisReport good = report_basis(reduce(full, basis));
    EXPECT_EQ(good.schur_rank, p_lambda);
    EXPECT_LT(good.schur_condition, 1e6);
    const ContactProblem reduced = reduce(full, basis);
    const DenseMatrix B = reduced.B.to_dense();
    const DenseMatrix S = B * reduced.K.to_dense().inverse() * B.transpose();
    const Eigen::JacobiSVD<DenseMatrix> svd(S);
    EXPECT_NEAR(good.schur_condition, svd.singularValues()[0] / svd.singularValues()[p_lambda - 1],
                1e-6 * good.schur_condition);
    basis.U_lambda.col(1) = 2 * basis.U_lambda.col(0);
    const BasisReport bad = report_basis(reduce(full, basis));
    EXPECT_EQ(bad.schur_rank, p_lambda - 1);
    EXPECT_EQ(bad.schur_condition, infinity);
    EXPECT_LT(bad.inf_sup_constant, 1e-14);
}

}  // namespace
}  // namespace tact
