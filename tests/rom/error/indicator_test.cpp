#include "../../../rom/error/indicator.hpp"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <cmath>

#include "../../../contact/dense/dense_contact.hpp"
#include "../../../integrators/sundials/bdf2.hpp"
#include "../../../lib/errors.hpp"
#include "../../../rom/model/reduce.hpp"
#include "../chain.hpp"

namespace tact {
namespace {

using testing::ChainFamily;
using testing::ChainParts;
using testing::scattered;

constexpr Index n = 21;

/// Eqs. 14 and 15 as printed: A u - b of each BDF2 stage from the lifted states of all steps, dense, with a
/// pseudo-inverse by another decomposition.
double as_printed(const ContactProblem& full, const DenseMatrix& U, const std::vector<Vector>& y, double dt,
                  const std::vector<long>& J, IndicatorWeights w) {
    const DenseMatrix K = full.K.to_dense(), M = full.M->to_dense(), B = full.B.to_dense();
    const DenseMatrix D = full.D ? full.D->to_dense() : DenseMatrix::Zero(n, n);
    const DenseMatrix B_plus = B.transpose().completeOrthogonalDecomposition().pseudoInverse();
    const Index p = U.cols();
    double sum = 0;
    for (const long step : J) {
        const auto k = static_cast<std::size_t>(step);
        const double a = step == 1 ? 1 / dt : 1.5 / dt;  // the first step is backward Euler
        const Vector b = step == 1 ? Vector(-y[0] / dt) : Vector((y[k - 2] - 4 * y[k - 1]) / (2 * dt));
        const Vector b_u = U * b.head(p), b_v = U * b.tail(p), u = U * y[k].head(p);
        const Vector rhs = full.f.at(static_cast<double>(step) * dt) - M * (b_v + a * b_u) - D * b_u;
        const Vector r1 = B * u - full.c.at(0);
        const Vector r3 = B_plus * ((a * a * M + a * D + K) * u - rhs);
        sum += w.penetration * r1.cwiseMin(0).squaredNorm() + w.complementarity * r3.cwiseProduct(r1).squaredNorm() +
               w.negativity * r3.cwiseMin(0).squaredNorm();
    }
    return sum;
}

class IndicatorOfChain : public ::testing::TestWithParam<std::pair<bool, bool>> {};

TEST_P(IndicatorOfChain, EqualsTheStageResidualsOfEq14) {
    const auto [damping, shared_rows] = GetParam();
    const ChainFamily family(n, {.damping = damping, .shared_rows = shared_rows});
    const Parameter gamma = Eigen::Vector2d(0.25, 0.4);
    const ContactProblem full = family.at(gamma);
    const ReducedBasis basis = modal_basis(full, {scattered(n, 6), scattered(full.constraints(), 4).cwiseAbs()});
    const ContactProblem reduced = reduce(family, basis)->at(gamma);

    const TimeGrid grid{0.1, 60, 0};
    const std::vector<long> J{1, 2, 17, 40, 60};
    ReducedStateRecorder recorder(J);
    std::vector<Vector> y;
    const std::vector<Observer> observers{recorder.observer(reduced), [&](const State& state, const StepReport&) {
                                              y.push_back(state.y);
                                              return Flow::proceed;
                                          }};
    ContactWorkspace contact(std::make_shared<DenseContact>());
    const MarchReport march = integrate(Bdf2(), reduced, grid, contact, observers);
    ASSERT_EQ(march.outcome, Outcome::converged);
    ASSERT_GT(march.most_active, 0);
    ASSERT_EQ(recorder.states().size(), 5);

    for (const IndicatorWeights w : {IndicatorWeights{1, 0, 0}, IndicatorWeights{0, 1, 0}, IndicatorWeights{0, 0, 1},
                                     IndicatorWeights{0.5, 2, 3}}) {
        const double expected = as_printed(full, basis.U, y, grid.dt, J, w);
        ASSERT_GT(expected, 1e-6);
        EXPECT_NEAR(Indicator(family, basis, w)(gamma, reduced, recorder.states()), expected, 1e-9 * expected);
    }
}

INSTANTIATE_TEST_SUITE_P(Parts, IndicatorOfChain,
                         ::testing::Values(std::pair{false, false}, std::pair{true, false}, std::pair{false, true},
                                           std::pair{true, true}));

/// Screening proves rows open from 16 of 40 modes; here against all gaps of all rows, some open and some not.
TEST(Indicator, WithManyModesCountsEveryViolatedRow) {
    constexpr Index large = 600, p = 40;
    const ChainFamily family(large);
    const ContactProblem full = family.at(Eigen::Vector2d(0.25, 0.4));
    const ReducedBasis basis = modal_basis(full, {scattered(large, p), scattered(full.constraints(), 4).cwiseAbs()});
    const std::unique_ptr<ContactFamily> reduced = reduce(family, basis);
    ReducedStates states;
    for (const double size : {1e-3, 0.3, 1.0, 3.0, 1000.0}) {
        states.q = size * scattered(p, 7, 3);
        for (Index j = 0; j < p; ++j) states.q.row(j) /= 1 + static_cast<double>(j);
        states.times.assign(7, 0.0);
        for (const double height : {0.0, 0.1, 0.3}) {
            const Parameter gamma = Eigen::Vector2d(height, 0.6);
            const ContactProblem at = family.at(gamma);
            DenseMatrix gap = at.B.times(basis.U) * states.q;
            gap.colwise() -= at.c.modes.col(0);
            const double expected = 2 * gap.cwiseMin(0).squaredNorm();
            EXPECT_NEAR(Indicator(family, basis, {2, 0, 0})(gamma, reduced->at(gamma), states), expected,
                        1e-12 * expected);
            if (size >= 3) {
                EXPECT_GT(expected, 0);
            } else if (size < 0.3) {
                EXPECT_EQ(expected, 0);
            }
        }
    }
}

TEST(Indicator, IsZeroForAnExactStaticSolutionAndNotForAWrongOne) {
    const ChainFamily family(n, {.mass = false, .moving_load = false});
    const Parameter gamma = Eigen::Vector2d(0.25, 0.4);
    const ContactProblem full = family.at(gamma);
    const ReducedBasis unit{testing::identity(n), testing::identity(full.constraints())};
    const ContactProblem same = reduce(full, unit);
    ContactWorkspace contact(std::make_shared<DenseContact>());
    const StaticSolution solution = solve_static(same, contact);
    ASSERT_GT(solution.report.active, 0);
    ReducedStates states;
    states.times = {0};
    states.q = solution.u;
    states.s = solution.lambda;
    EXPECT_LT(Indicator(family, unit, {1, 1, 1})(gamma, same, states), 1e-20);
    states.q.array() -= 0.1;
    EXPECT_GT(Indicator(family, unit, {1, 0, 0})(gamma, same, states), 1e-3);
}

/// A family that switches one row off.
class GappyFamily final : public ChainFamily {
public:
    using ChainFamily::ChainFamily;
    static constexpr Index off = 5;
    ContactProblem at(const Parameter& gamma) const override {
        ContactProblem problem = ChainFamily::at(gamma);
        problem.c.modes(off, 0) = -infinity;
        return problem;
    }
    void gap(const Parameter& gamma, std::span<const Index> rows, VectorRef out) const override {
        ChainFamily::gap(gamma, rows, out);
        for (std::size_t k = 0; k < rows.size(); ++k)
            if (rows[k] == off) out[static_cast<Index>(k)] = -infinity;
    }
};

TEST(Indicator, CountsNothingInRowsThatAreOff) {
    const ChainParts still{.mass = false, .moving_load = false};
    const GappyFamily gappy(n, still);
    const ChainFamily whole(n, still);
    const Parameter gamma = Eigen::Vector2d(0.25, 0.4);
    const ContactProblem full = whole.at(gamma);
    const ReducedBasis basis{testing::identity(n), DenseMatrix(full.constraints(), 0)};
    const ContactProblem reduced = reduce(full, basis);
    ReducedStates states;
    states.times = {0};
    states.q = scattered(n, 1);
    const IndicatorWeights w{1, 1, 1};
    // What the row would count, by hand: B is a unit row there.
    const Index i = 2 * GappyFamily::off;
    const double r1 = states.q(i, 0) - full.c.modes(GappyFamily::off, 0);
    const double r3 = (full.K.to_dense() * states.q - full.f.at(0))(i, 0);
    const double row = std::pow(std::min(r1, 0.0), 2) + r1 * r1 * r3 * r3 + std::pow(std::min(r3, 0.0), 2);
    EXPECT_NEAR(Indicator(gappy, basis, w)(gamma, reduced, states),
                Indicator(whole, basis, w)(gamma, reduced, states) - row, 1e-12);
}

TEST(Indicator, RefusesNegativeWeightsAndForeignStates) {
    const ChainFamily family(n);
    const ReducedBasis basis{scattered(n, 3), DenseMatrix((n + 1) / 2, 0)};
    EXPECT_THROW(Indicator(family, basis, {-1, 0, 0}), InputError);
    EXPECT_THROW(Indicator(family, basis, {0, std::nan(""), 0}), InputError);
    ReducedStates states;
    states.times = {0};
    states.q = Vector::Zero(4);
    const Parameter gamma = family.lower();
    EXPECT_THROW(Indicator(family, basis)(gamma, reduce(family.at(gamma), basis), states), InputError);
}

}  // namespace
}  // namespace tact
