// Bounds on both sides on finer and finer grids, against what others print for the same data.
#include "../../../contact/prepare/interval_contact.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "../../../contact/automatic.hpp"
#include "../../../contact/strategies/klu_active_set.hpp"

namespace tact {
namespace {

/// u_t = u_xx + f on (0, 10), f = -1 where x < 5 and 1 elsewhere, 0 <= u <= 10, u(0) = 0 and u(10) = 10 as equations, u = x at
/// first; linear elements with their own mass, implicit Euler with dt = 1 (MOOSE issue 14166, vi-bounding.i).
struct Bounded {
    explicit Bounded(Index cells) : h(10.0 / static_cast<double>(cells)), u(Vector::LinSpaced(cells + 1, 0, 10)) {
        const Index n = cells + 1;
        std::vector<Eigen::Triplet<double, long>> mass, all;
        const auto add = [&](Index i, Index j, double m, double k) {
            mass.emplace_back(i, j, m * h / 6);
            all.emplace_back(i, j, m * h / 6 + k / h);
        };
        for (Index i = 0; i < cells; ++i) {
            add(i, i, 2, 1);
            add(i + 1, i + 1, 2, 1);
            add(i, i + 1, 1, -1);
            add(i + 1, i, 1, -1);
        }
        M.resize(n, n);
        M.setFromTriplets(mass.begin(), mass.end());
        SparseMatrix A(n, n);
        A.setFromTriplets(all.begin(), all.end());
        matrix = Matrix(std::move(A));
        lower = Vector::Zero(n);
        upper = Vector::Constant(n, 10);
        upper[0] = 0;
        lower[n - 1] = 10;
        f = (u.array() < 5).select(Vector::Constant(n, -h), Vector::Constant(n, h));
        lambda = Vector::Zero(n);
    }
    ContactReport step(PreparedContact& contact) {
        const Vector b = M * u + f;
        return contact.solve_rows(b, {lower, &upper}, {u, lambda});
    }
    double at(double x) const {
        const Index i = static_cast<Index>(x / h);
        return u[i] + (x / h - static_cast<double>(i)) * (u[i + 1] - u[i]);
    }

    double h;
    Vector u, lower, upper, f, lambda;
    SparseMatrix M;
    Matrix matrix;
};

/// A plain active set needs 6, 10, 19, 35, 69 and 269 sets for these grids.
TEST(IntervalContact, TheNumberOfSetsDoesNotGrowWithTheGrid) {
    for (const Index cells : {100, 200, 400, 800, 1600, 6400}) {
        Bounded problem(cells);
        const auto contact = IntervalContact(std::make_shared<KluActiveSet>())
                                 .prepare_rows(problem.matrix, Matrix::identity(cells + 1));
        for (int step = 1; step <= 10; ++step) {
            const ContactReport report = problem.step(*contact);
            ASSERT_EQ(report.outcome, Outcome::converged) << cells << " cells, step " << step;
            EXPECT_LE(report.iterations, 8) << cells << " cells, step " << step;
        }
    }
}

/// The printed values at x = 2.5 and 7 after ten steps.
TEST(IntervalContact, GivesTheValuesThatOthersPrint) {
    const AutomaticContact solver;
    for (const auto& [cells, left, right] :
         {std::tuple(Index{800}, 0.22593940, 9.32664514), std::tuple(Index{6400}, 0.22270495, 9.32098520)}) {
        Bounded problem(cells);
        const auto contact = solver.prepare_rows(problem.matrix, Matrix::identity(cells + 1));
        for (int step = 0; step < 10; ++step) ASSERT_EQ(problem.step(*contact).outcome, Outcome::converged);
        EXPECT_NEAR(problem.at(2.5), left, 2e-8) << cells;
        EXPECT_NEAR(problem.at(7), right, 2e-8) << cells;
    }
}

}  // namespace
}  // namespace tact
