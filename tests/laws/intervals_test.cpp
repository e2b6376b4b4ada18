// Rows with two intervals, of every strategy: against every combination of row states tried one by one (code shared with no
// solver), and the certificate against states that are wrong on purpose.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <random>

#include "../../contact/prepare/interval_contact.hpp"
#include "strategies.hpp"

namespace tact::laws {
namespace {

enum class At { between, lower, upper, gives_way_up, gives_way_down };

struct IntervalProgram {
    QuadraticProgram qp;  // c: the lower bounds
    Vector upper, force_lower, force_upper;
    RowBounds rows() const { return {qp.c, &upper, &force_lower, &force_upper}; }
};

IntervalProgram random_intervals(std::mt19937& random, Index n, Index m, Rows shape) {
    IntervalProgram p{random_program(random, n, m, shape), {}, {}, {}};
    p.upper = Vector::Constant(m, infinity);
    p.force_lower = Vector::Constant(m, -infinity);
    p.force_upper = Vector::Constant(m, infinity);
    std::uniform_int_distribution<int> kind(0, 4);
    std::uniform_real_distribution<double> size(0.01, 0.5);
    for (Index i = 0; i < m; ++i) switch (kind(random)) {
            case 0: break;                                         // contact
            case 1: p.upper[i] = p.qp.c[i] + size(random); break;  // both sides
            case 2: p.upper[i] = p.qp.c[i]; break;                 // an equation
            case 3:                                                // a friction bound
                p.upper[i] = p.qp.c[i];
                p.force_upper[i] = size(random);
                p.force_lower[i] = -p.force_upper[i];
                break;
            default: p.force_upper[i] = size(random);  // contact that gives way
        }
    return p;
}

/// The one state of all rows that satisfies every condition.
std::optional<Solution> by_states(const IntervalProgram& p, double tolerance = 1e-9) {
    const Index n = p.qp.A.rows(), m = p.qp.B.rows();
    long combinations = 1;
    for (Index i = 0; i < m; ++i) combinations *= 5;
    for (long combination = 0; combination < combinations; ++combination) {
        std::vector<Index> held;
        Vector target(m), load = p.qp.b, lambda = Vector::Zero(m);
        std::vector<At> state;
        bool possible = true;
        long rest = combination;
        for (Index i = 0; i < m && possible; ++i, rest /= 5) {
            const At at = static_cast<At>(rest % 5);
            state.push_back(at);
            if (at == At::lower || at == At::upper) {
                target[i] = at == At::lower ? p.qp.c[i] : p.upper[i];
                held.push_back(i);
                possible = std::isfinite(target[i]);
            } else if (at != At::between) {
                lambda[i] = at == At::gives_way_up ? p.force_upper[i] : p.force_lower[i];
                possible = std::isfinite(lambda[i]);
                if (possible) load += lambda[i] * p.qp.B.row(i).transpose();
            }
        }
        const Index k = static_cast<Index>(held.size());
        if (!possible || k > n) continue;
        DenseMatrix kkt = DenseMatrix::Zero(n + k, n + k);
        Vector rhs(n + k);
        kkt.topLeftCorner(n, n) = p.qp.A;
        rhs.head(n) = load;
        for (Index j = 0; j < k; ++j) {
            const Index row = held[static_cast<std::size_t>(j)];
            kkt.block(n + j, 0, 1, n) = p.qp.B.row(row);
            kkt.block(0, n + j, n, 1) = -p.qp.B.row(row).transpose();
            rhs[n + j] = target[row];
        }
        const Eigen::FullPivLU<DenseMatrix> lu(kkt);
        if (!lu.isInvertible()) continue;
        const Vector x = lu.solve(rhs);
        for (Index j = 0; j < k; ++j) lambda[held[static_cast<std::size_t>(j)]] = x[n + j];
        const Vector place = p.qp.B * x.head(n);
        for (Index i = 0; i < m && possible; ++i) {
            const At at = state[static_cast<std::size_t>(i)];
            if (at == At::between) possible = place[i] >= p.qp.c[i] - tolerance && place[i] <= p.upper[i] + tolerance;
            if (at == At::lower && p.qp.c[i] < p.upper[i]) possible = lambda[i] >= -tolerance;
            if (at == At::upper && p.qp.c[i] < p.upper[i]) possible = lambda[i] <= tolerance;
            if (at == At::lower || at == At::upper)
                possible &= lambda[i] <= p.force_upper[i] + tolerance && lambda[i] >= p.force_lower[i] - tolerance;
            if (at == At::gives_way_up) possible = place[i] <= p.qp.c[i] + tolerance;
            if (at == At::gives_way_down) possible = place[i] >= p.upper[i] - tolerance;
        }
        if (possible) return Solution{x.head(n), lambda};
    }
    return std::nullopt;
}

Solved solve_intervals(const ContactSolver& solver, const IntervalProgram& p) {
    Solved s{{}, Vector::Zero(p.qp.A.rows()), Vector::Zero(p.qp.c.size())};
    s.report = solver.prepare_rows(Matrix(p.qp.A), Matrix(p.qp.B))->solve_rows(p.qp.b, p.rows(), {s.u, s.lambda});
    return s;
}

TEST(Intervals, EveryStrategyFindsTheStateThatEnumerationFinds) {
    std::mt19937 random(7);
    int compared = 0;
    for (int draw = 0; draw < 150; ++draw) {
        const auto shape = static_cast<Rows>(draw % 3);
        const IntervalProgram p = random_intervals(random, 6, shape == Rows::pairs ? 3 : 4, shape);
        const std::optional<Solution> exact = by_states(p);
        if (!exact) continue;
        for (const Strategy& strategy : strategies()) {
            if (std::ranges::find(strategy.takes, shape) == strategy.takes.end()) continue;
            Solved s;
            try {
                s = solve_intervals(IntervalContact(strategy.solver), p);
            } catch (const InputError&) {
                continue;  // both sides of a row share its unknowns: not for who takes disjoint rows only
            }
            if (!strategy.always_ends && s.report.outcome != Outcome::converged) continue;
            ASSERT_EQ(s.report.outcome, Outcome::converged) << strategy.name << ", draw " << draw;
            EXPECT_LE((s.u - exact->u).lpNorm<Eigen::Infinity>(), 1e-8) << strategy.name << ", draw " << draw;
            EXPECT_LE((p.qp.B.transpose() * (s.lambda - exact->lambda)).lpNorm<Eigen::Infinity>(), 1e-7)
                << strategy.name << ", draw " << draw;
            EXPECT_LE(s.report.kkt.largest(), 1e-9) << strategy.name << ", draw " << draw;
            ++compared;
        }
    }
    EXPECT_GT(compared, 800);
}

TEST(Intervals, TheChooserHasThem) {
    std::mt19937 random(11);
    for (int draw = 0; draw < 100; ++draw) {
        const IntervalProgram p = random_intervals(random, 5, 4, Rows::general);
        const std::optional<Solution> exact = by_states(p);
        if (!exact) continue;
        const Solved s = solve_intervals(AutomaticContact(), p);
        ASSERT_EQ(s.report.outcome, Outcome::converged) << draw;
        EXPECT_LE((s.u - exact->u).lpNorm<Eigen::Infinity>(), 1e-8) << draw;
    }
}

/// The resultant of a rigid bar on two springs that slip at .3 and .5: by hand.
TEST(Intervals, AFrictionBoundGivesWayAtItsForce) {
    IntervalProgram p;
    p.qp.A = DenseMatrix::Identity(1, 1);
    p.qp.B = DenseMatrix::Ones(1, 1);
    p.qp.b = Vector::Constant(1, -1);  // pulls down: u = -1 + lambda
    p.qp.c = p.upper = Vector::Zero(1);
    p.force_upper = Vector::Constant(1, 0.3);
    p.force_lower = -p.force_upper;
    Solved s = solve_intervals(AutomaticContact(), p);
    ASSERT_EQ(s.report.outcome, Outcome::converged);
    EXPECT_DOUBLE_EQ(s.lambda[0], 0.3);
    EXPECT_DOUBLE_EQ(s.u[0], -0.7);
    p.qp.b[0] = -0.2;  // sticks
    s = solve_intervals(AutomaticContact(), p);
    ASSERT_EQ(s.report.outcome, Outcome::converged);
    EXPECT_DOUBLE_EQ(s.lambda[0], 0.2);
    EXPECT_EQ(s.u[0], 0);
    p.qp.b[0] = 2;  // the other way
    s = solve_intervals(AutomaticContact(), p);
    EXPECT_DOUBLE_EQ(s.lambda[0], -0.3);
    EXPECT_DOUBLE_EQ(s.u[0], 1.7);
}

TEST(Intervals, EquationsThatExcludeEachOtherAreProvenTo) {
    IntervalProgram p;
    p.qp.A = DenseMatrix::Identity(2, 2);
    p.qp.B = DenseMatrix{{1, 1}, {2, 2}};
    p.qp.b = Vector::Zero(2);
    p.qp.c = Vector{{1, 3}};
    p.upper = p.qp.c;
    p.force_lower = Vector::Constant(2, -infinity);
    p.force_upper = Vector::Constant(2, infinity);
    const Solved s = solve_intervals(AutomaticContact(), p);
    ASSERT_EQ(s.report.outcome, Outcome::infeasible);
    const Vector& y = s.report.infeasibility;
    ASSERT_EQ(y.size(), 2);
    EXPECT_LE((p.qp.B.transpose() * y).lpNorm<Eigen::Infinity>(), 1e-9);
    EXPECT_GT(y.dot(p.qp.c), 0);
}

TEST(Intervals, TheCertificateSeesEachWrong) {
    const Matrix A = Matrix::identity(1), B = Matrix::identity(1);
    const KktCertificate certificate(A, B);
    const auto judged = [&](double u, double lambda, double lower, double upper, double least, double most) {
        const Vector b = Vector::Constant(1, u - lambda), c = Vector::Constant(1, lower);
        const Vector up = Vector::Constant(1, upper), low = Vector::Constant(1, least),
                     high = Vector::Constant(1, most);
        return certificate(b, RowBounds(c, &up, &low, &high), Vector(Vector::Constant(1, u)),
                           Vector(Vector::Constant(1, lambda)));
    };
    EXPECT_LE(judged(1, 2, 1, 3, -infinity, infinity).largest(), 1e-15);
    EXPECT_LE(judged(3, -2, 1, 3, -infinity, infinity).largest(), 1e-15);
    EXPECT_LE(judged(2, 0, 1, 3, -infinity, infinity).largest(), 1e-15);
    EXPECT_LE(judged(-1, .5, 1, 1, -.5, .5).largest(), 1e-15);
    EXPECT_LE(judged(2, -.5, 1, 1, -.5, .5).largest(), 1e-15);
    EXPECT_GT(judged(4, 0, 1, 3, -infinity, infinity).penetration, 0.1);
    EXPECT_GT(judged(0, 0, 1, 3, -infinity, infinity).penetration, 0.1);
    EXPECT_GT(judged(2, 1, 1, 3, -infinity, infinity).complementarity, 0.1);
    EXPECT_GT(judged(2, -1, 1, 3, -infinity, infinity).complementarity, 0.1);
    EXPECT_GT(judged(1, -1, 1, infinity, -infinity, infinity).negativity, 0.1);
    EXPECT_GT(judged(1, 1, 1, 1, -.5, .5).negativity, 0.1);
    EXPECT_GT(judged(-1, .4, 1, 1, -.5, .5).penetration, 0.1);
    EXPECT_GT(judged(1, 1, -infinity, infinity, -infinity, infinity).negativity, 0.1);
    EXPECT_EQ(judged(std::nan(""), 0, 0, 1, -infinity, infinity).largest(), infinity);
}

}  // namespace
}  // namespace tact::laws
