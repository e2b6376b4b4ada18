#include "../../bench/harness/basis_errors.hpp"

#include <gtest/gtest.h>

#include <array>

#include "../../integrators/sundials/bdf2.hpp"
#include "../../lib/time/trajectory.hpp"
#include "../../rom/error/relative_error.hpp"

namespace tact::bench {
namespace {

/// Sines: a basis that is bad enough to have an error, and nothing to do with any run.
ReducedBasis sines(const ContactProblem& problem, Index p) {
    ReducedBasis basis{DenseMatrix(problem.size(), p), DenseMatrix::Zero(problem.constraints(), p)};
    for (Index j = 0; j < p; ++j)
        for (Index i = 0; i < problem.size(); ++i) {
            basis.U(i, j) = std::sin(0.01 * static_cast<double>((i + 1) * (j + 1)));
            if (i % p == j) basis.U_lambda(i, j) = 1;
        }
    return modal_basis(problem, basis);
}

TEST(BasisErrors, AreTheLibrarysRelativeErrors) {
    for (const char* name : {"static-obstacle", "dynamic-obstacle"}) {
        const StudyScene scene = study_scene(name, 12);
        const Scheme scheme =
            scene.is_static() ? Scheme{} : Scheme{std::make_shared<Bdf2>(), TimeGrid::until(0.4, 0.02)};
        const std::vector<Parameter> gammas{Eigen::Vector2d(0.4, 0.5), Eigen::Vector2d(0.6, 0.3)};
        const ReducedBasis basis = sines(scene.family->at(gammas[0]), 5);
        const std::shared_ptr<const ContactFamily> reduced = reduce(scene.family, basis);
        ContactWorkspace workspace(study_contact().full), reduced_workspace(study_contact().reduced);
        const FullStates full = full_states(scene, scheme, gammas, workspace);
        EXPECT_EQ(full.width(), scene.is_static() ? 1 : 21);
        const std::vector<double> percents = squared_percents({basis.U, reduced}, scheme, full);
        for (std::size_t k = 0; k < 2; ++k) {
            const ContactProblem problem = scene.family->at(gammas[k]), small = reduced->at(gammas[k]);
            RelativeError expected;
            if (scene.is_static()) {
                expected = relative_error(problem, solve_static(problem, workspace), basis,
                                          solve_static(small, reduced_workspace));
            } else {
                Trajectory u(problem, scheme.grid.steps), q(small, scheme.grid.steps);
                const std::array on_full{u.observer()}, on_reduced{q.observer()};
                (void)run("full", problem, scheme, workspace, on_full);
                (void)run("reduced", small, scheme, reduced_workspace, on_reduced);
                expected = relative_error(problem, u, basis, q);
            }
            ASSERT_GT(expected.squared_percent, 1e-3);
            EXPECT_NEAR(percents[k], expected.squared_percent, 1e-8 * expected.squared_percent);
        }
    }
}

}  // namespace
}  // namespace tact::bench
