// Exchanges of selected rows against the error on training runs.
#include <gtest/gtest.h>

#include <Eigen/QR>
#include <set>

#include "../../../contact/dense/dense_contact.hpp"
#include "../../../integrators/sundials/bdf2.hpp"
#include "../../../rom/greedy/greedy.hpp"
#include "../../../rom/greedy/sampling.hpp"
#include "../../../rom/greedy/training_error.hpp"
#include "../chain.hpp"

namespace tact {
namespace {

using testing::ChainFamily;

const TrainingContact contact{std::make_shared<DenseContact>(), std::make_shared<DenseContact>()};
const TrainingMethod marching{std::make_shared<Bdf2>(), TimeGrid{0.1, 60, 0}};

std::vector<Index> rows_of(const ReducedBasis& basis) {
    std::vector<Index> rows(static_cast<std::size_t>(basis.dual_size()));
    for (Index j = 0; j < basis.dual_size(); ++j) basis.U_lambda.col(j).maxCoeff(&rows[static_cast<std::size_t>(j)]);
    return rows;
}

TrainingOptions in_order(const ContactFamily& family) {
    TrainingOptions options;
    options.candidates = tensor_grid(family.lower(), family.upper(), {3, 3});
    options.max_iterations = 9;
    options.selection = Selection::in_order;
    options.compression = Compression::pod_and_dual_basis;
    options.sizes = [](int) { return BasisSizes{2, 3}; };
    return options;
}

/// The same sum from runs of its own, states lifted to the full size.
double lifted_error(const ContactFamily& family, const TrainingMethod& method, const ReducedBasis& basis,
                    const std::vector<Parameter>& samples) {
    const DenseMatrix Q = Eigen::HouseholderQR<DenseMatrix>(basis.U).householderQ() *
                          DenseMatrix::Identity(basis.U.rows(), basis.U.cols());
    double sum = 0;
    for (const Parameter& gamma : samples) {
        DenseMatrix u(basis.U.rows(), method.grid.steps + 1), q(basis.U.cols(), method.grid.steps + 1);
        const auto into = [](DenseMatrix& X) {
            X.setZero();
            return std::vector<Observer>{[&X](const State& state, const StepReport&) {
                X.col(state.step) = state.u();
                return Flow::proceed;
            }};
        };
        ContactWorkspace full(contact.full), reduced(contact.reduced);
        (void)run_by(method, family.at(gamma), full, into(u));
        (void)run_by(method, reduce(family.at(gamma), basis), reduced, into(q));
        sum += (basis.U * q - Q * (Q.transpose() * u)).squaredNorm() / u.squaredNorm();
    }
    return sum;
}

TEST(RowSwaps, NeverRaiseTheTrainingErrorAndEndAtTheErrorOfLiftedRuns) {
    for (const bool moving : {true, false}) {
        const ChainFamily family(41, {.mass = moving, .moving_load = moving});
        const TrainingMethod method = moving ? marching : TrainingMethod{nullptr, TimeGrid{1, 0, 0}};
        TrainingOptions options = in_order(family);
        TrainingError error(family, method, contact, options.candidates);
        options.dual_basis = selected_rows();
        const TrainingResult plain = train(family, method, contact, options);
        options.dual_basis = selected_rows({.tries = 60, .seed = 3, .error = std::ref(error)});
        const TrainingResult swapped = train(family, method, contact, options);
        ASSERT_EQ(swapped.outcome, Outcome::converged);
        const std::vector<double>& errors = swapped.history.back().residuals;
        ASSERT_GT(errors.size(), 1u);
        for (std::size_t k = 1; k < errors.size(); ++k) EXPECT_LT(errors[k], errors[k - 1]);
        EXPECT_NEAR(errors.front(), lifted_error(family, method, plain.basis, options.candidates),
                    1e-9 * errors.front());
        EXPECT_NEAR(errors.back(), lifted_error(family, method, swapped.basis, options.candidates),
                    1e-9 * errors.front());
        const TrainingResult again = train(family, method, contact, options);
        EXPECT_EQ(again.basis.U_lambda, swapped.basis.U_lambda);
        const std::vector<Index> rows = rows_of(swapped.basis);
        EXPECT_EQ(std::set<Index>(rows.begin(), rows.end()).size(), rows.size());
    }
}

TEST(RowSwaps, AreNotTriedWithoutTriesOrWithoutRowsLeft) {
    const ChainFamily family(41, {.mass = false, .moving_load = false});
    TrainingOptions options = in_order(family);
    const auto none = [](const DenseMatrix&, const std::vector<Index>&) -> double { throw InputError("asked"); };
    options.dual_basis = selected_rows({.tries = 0, .error = none});
    const DenseMatrix plain = train(family, {}, contact, options).basis.U_lambda;
    options.dual_basis = selected_rows();
    EXPECT_EQ(train(family, {}, contact, options).basis.U_lambda, plain);
    options.sizes = [](int) { return BasisSizes{4, 500}; };
    options.dual_basis = selected_rows({.tries = 5, .error = none});
    EXPECT_GT(train(family, {}, contact, options).basis.dual_size(), 3);
}

TEST(RowSwaps, RefuseTriesWithoutAnError) {
    EXPECT_THROW((void)selected_rows({.tries = 1}), InputError);
    EXPECT_THROW((void)selected_rows({.tries = -1}), InputError);
    const ChainFamily family(11);
    EXPECT_THROW(TrainingError(family, {}, contact, {}), InputError);
}

}  // namespace
}  // namespace tact
