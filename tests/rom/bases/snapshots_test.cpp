#include "../../../rom/bases/snapshots.hpp"

#include <gtest/gtest.h>

#include "../../../contact/dense/dense_contact.hpp"
#include "../../../integrators/sundials/bdf2.hpp"
#include "../../../lib/errors.hpp"
#include "../../../lib/time/trajectory.hpp"
#include "../chain.hpp"

namespace tact {
namespace {

using testing::chain;

TEST(DualSnapshots, KeepContactOnlyAndNoRounding) {
    DualSnapshots dual(4);
    dual.add(Eigen::Vector4d(0, 0, 0, 0));
    dual.add(Eigen::Vector4d(2, 0, 1e-13, -1e-14));
    dual.add(Eigen::Vector4d(-1e-14, 0, 0, 0));
    dual.add(Eigen::Vector4d(0, 0, 3, 1));
    ASSERT_EQ(dual.size(), 2);
    DenseMatrix expected(4, 2);
    expected << 2, 0, 0, 0, 0, 3, 0, 1;
    EXPECT_EQ(DenseMatrix(dual.matrix()), expected);
    EXPECT_THROW(dual.add(Vector::Zero(3)), InputError);
    EXPECT_EQ(DualSnapshots(0).matrix().cols(), 0);
}

/// A recorder's primal snapshots in one piece, and how wide its blocks were.
struct Collected {
    DenseMatrix primal;
    std::vector<Index> widths;
    SnapshotRecorder::Sink sink() {
        return [this](const auto& block) {
            primal.conservativeResize(block.rows(), primal.cols() + block.cols());
            primal.rightCols(block.cols()) = block;
            widths.push_back(block.cols());
        };
    }
};

TEST(SnapshotRecorder, KeepsTheStatesOfATrajectoryAtItsStrides) {
    const ContactProblem problem = chain(12, -0.1);
    const TimeGrid grid{0.1, 40, 0};
    DualSnapshots dual(problem.constraints());
    Collected collected;
    SnapshotRecorder recorder(problem.size(), grid.steps, {3, 2}, dual, collected.sink());
    for (int run = 1; run <= 2; ++run) {
        collected.primal.resize(problem.size(), 0);
        Trajectory trajectory(problem, grid.steps);
        ContactWorkspace contact(std::make_shared<DenseContact>());
        const std::vector<Observer> observers{recorder.observer(), trajectory.observer()};
        ASSERT_EQ(integrate(Bdf2(), problem, grid, contact, observers).outcome, Outcome::converged);
        recorder.flush();
        ASSERT_EQ(collected.primal.cols(), 13);  // steps 3, 6, .., 39: the state at rest is zero and not kept
        for (Index j = 0; j < 13; ++j) EXPECT_EQ(collected.primal.col(j), trajectory.u().col(3 * j + 3));
        Index touching = 0;
        for (Index j = 0; j < trajectory.size(); j += 2) touching += trajectory.lambda().col(j).maxCoeff() > 0;
        ASSERT_GT(touching, 3);
        EXPECT_EQ(dual.size(), run * touching);
    }
}

/// One unknown and one row, at the values given.
void tell(const Observer& observer, const std::vector<double>& values) {
    State state;
    state.n = 1;
    for (const double x : values) {
        state.y = state.lambda = Vector::Constant(1, x);
        EXPECT_EQ(observer(state, {}), Flow::proceed);
        ++state.step;
    }
}

TEST(SnapshotRecorder, HandsOnBlocksOfBoundedAndEqualWidth) {
    DualSnapshots dual(1);
    Collected collected;
    SnapshotRecorder recorder(1, 1000, {}, dual, collected.sink());
    std::vector<double> values(1001);
    for (std::size_t k = 0; k < values.size(); ++k) values[k] = static_cast<double>(k + 1);
    tell(recorder.observer(), values);
    recorder.flush();
    EXPECT_EQ(collected.primal, Eigen::Map<const DenseMatrix>(values.data(), 1, 1001));
    EXPECT_EQ(collected.widths, (std::vector<Index>{334, 334, 333}));
}

TEST(SnapshotRecorder, LeavesOutWhatIsWithinTheToleranceOfTheOneKeptLast) {
    DualSnapshots dual(1);
    Collected collected;
    SnapshotRecorder recorder(1, 9, {.tolerance = 0.1}, dual, collected.sink());
    for (int run = 0; run < 2; ++run) {  // the second one is compared with nothing of the first
        tell(recorder.observer(), {0, 1, 1.05, 1.1, 1.12, 1.2, 1.25, -1.25, 0, 1.25});
        recorder.flush();
    }
    const DenseMatrix once = Eigen::RowVectorXd{{1, 1.12, 1.25, -1.25, 1.25}};
    EXPECT_EQ(collected.primal.leftCols(5), once);
    EXPECT_EQ(collected.primal.rightCols(5), once);
    const DenseMatrix once_dual = Eigen::RowVectorXd{{1, 1.12, 1.25, 1.25}};
    EXPECT_EQ(DenseMatrix(dual.matrix()).leftCols(4), once_dual);
    EXPECT_EQ(dual.size(), 8);
}

TEST(SnapshotRecorder, RefusesStridesBelowOneAndTolerancesOffTheirRange) {
    DualSnapshots dual(2);
    EXPECT_THROW(SnapshotRecorder(4, 10, {0, 1}, dual, nullptr), InputError);
    EXPECT_THROW(SnapshotRecorder(4, 10, {1, -2}, dual, nullptr), InputError);
    EXPECT_THROW(SnapshotRecorder(4, 10, {.tolerance = -1}, dual, nullptr), InputError);
    EXPECT_THROW(SnapshotRecorder(4, 10, {.tolerance = 1}, dual, nullptr), InputError);
}

}  // namespace
}  // namespace tact
