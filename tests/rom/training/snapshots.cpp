#include "tact/rom/training/snapshots.hpp"

#include <gtest/gtest.h>

#include "tact/contact/dense/dense_contact.hpp"
#include "tact/integrators/bdf2.hpp"
#include "tact/lib/errors.hpp"
#include "tact/lib/trajectory.hpp"
#include "tact/tests/rom/chain.hpp"

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

TEST(SnapshotRecorder, KeepsTheStatesOfATrajectoryAtItsStrides) {
    const ContactProblem problem = chain(12, -0.1);
    const TimeGrid grid{0.1, 40, 0};
    DualSnapshots dual(problem.constraints());
    SnapshotRecorder recorder(problem.size(), grid.steps, {3, 2}, dual);
    for (int run = 1; run <= 2; ++run) {  // the second run replaces the primal snapshots and adds to the dual ones
        Trajectory trajectory(problem, grid.steps);
        ContactWorkspace contact(std::make_shared<DenseContact>());
        const std::vector<Observer> observers{recorder.observer(), trajectory.observer()};
        ASSERT_EQ(integrate(Bdf2(), problem, grid, contact, observers).outcome, Outcome::converged);
        ASSERT_EQ(recorder.primal().cols(), 13);  // steps 3, 6, .., 39: the state at rest is zero and not kept
        for (Index j = 0; j < 13; ++j) EXPECT_EQ(recorder.primal().col(j), trajectory.u().col(3 * j + 3));
        Index touching = 0;
        for (Index j = 0; j < trajectory.size(); j += 2) touching += trajectory.lambda().col(j).maxCoeff() > 0;
        ASSERT_GT(touching, 3);
        EXPECT_EQ(dual.size(), run * touching);
    }
}

TEST(SnapshotRecorder, RefusesStridesBelowOne) {
    DualSnapshots dual(2);
    EXPECT_THROW(SnapshotRecorder(4, 10, {0, 1}, dual), InputError);
    EXPECT_THROW(SnapshotRecorder(4, 10, {1, -2}, dual), InputError);
}

}  // namespace
}  // namespace tact
