#include "central_difference.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

#include "../lib/algebra/row_runs.hpp"
#include "../lib/time/naming.hpp"
#include "hermite.hpp"
#include "impact.hpp"
#include "jumping_load.hpp"

namespace tact {
namespace {

/// Gershgorin's upper bound of the largest eigenvalue of M^-1 K for a diagonal M.
double circles(const Matrix& K, const Vector& mass) {
    const SparseMatrix entries = K.to_sparse();
    Vector sums = Vector::Zero(K.rows());
    for (Index j = 0; j < entries.outerSize(); ++j)
        for (SparseMatrix::InnerIterator it(entries, j); it; ++it) sums[it.row()] += std::abs(it.value());
    return sums.size() > 0 ? sums.cwiseQuotient(mass).maxCoeff() : 0;
}

/// An upper bound of the largest eigenvalue of M^-1 K, but for a start vector without a share in it: the largest Ritz
/// value and its residual.
double lanczos(const ContactProblem& problem, VelocityProjection& mass) {
    constexpr Index look_every = 20, most_steps = 400;
    constexpr double sharp = 1e-4;
    const Index n = problem.size();
    const Index most = std::min(n, most_steps);
    Vector q(n), before = Vector::Zero(n), work(n), weighted(n), alpha(most), beta(most);
    // A fixed pseudo-random start: every mode has a share in it, whatever the numbering and the symmetry of the mesh.
    std::mt19937_64 random(1);
    for (double& x : q) x = static_cast<double>(random() >> 11) * 0x1p-53 - 0.5;
    problem.M->multiply(q, weighted);
    q /= std::sqrt(q.dot(weighted));
    double bound = 0;
    for (Index j = 0; j < most; ++j) {
        problem.K.multiply(q, work);
        alpha[j] = q.dot(work);
        mass.solve_mass(0, work);
        work -= alpha[j] * q;
        if (j > 0) work -= beta[j - 1] * before;
        problem.M->multiply(work, weighted);
        beta[j] = std::sqrt(std::max(work.dot(weighted), 0.0));
        const bool ended = j + 1 == most || !(beta[j] > 1e-13 * alpha[j]);
        if (ended || (j + 1) % look_every == 0) {
            Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> ritz;
            ritz.computeFromTridiagonal(alpha.head(j + 1), beta.head(j));
            const double value = ritz.eigenvalues()[j];
            const double residual = beta[j] * std::abs(ritz.eigenvectors()(j, j));
            bound = value + residual;
            if (ended || residual <= sharp * value) break;
        }
        before.swap(q);
        q = work / beta[j];
    }
    return bound;
}

class CentralRun final : public Run {
public:
    CentralRun(const Shared<ContactProblem>& problem, const TimeGrid& grid, const ContactWorkspace& workspace,
               double restitution)
        : owned_(problem),
          grid_(grid),
          stages_(problem, workspace),
          load_(problem, stages_),
          stiffness_(problem->K),
          mass_(workspace.prepared(*problem, {1, 0, 0})),
          velocity_(problem, workspace, restitution, true),
          now_(*problem, grid.t0),
          next_(now_),
          force_(problem->size()),
          momentum_(problem->size()),
          work_(problem->size()),
          bound_(problem->constraints()),
          closing_(Vector::Zero(problem->constraints())),
          scratch_(problem->c.mode_count()) {}

    const State& state() const override { return now_; }
    void dense(double t, State& out) const override { interpolate(next_, now_, t, out); }

    StepReport advance() override {
        const double h = grid_.dt;
        if (now_.step == 0) begin();
        StepReport report{grid_.t(now_.step + 1), now_.step + 1};
        kick_and_drift();
        problem_.c.evaluate(report.t, Side::right, scratch_, bound_);
        if (mass_->reads_guess()) next_.u() = now_.u();
        next_.lambda = closing_;
        report.contact = mass_->solve(work_, bound_, {next_.u(), next_.lambda});
        report.outcome = report.contact.outcome;
        if (report.outcome != Outcome::converged) return report;
        coming_ = next_.lambda;
        next_.t = report.t;
        const bool closed = (coming_.array() > 0).any();
        if (closed) {
            velocity_.press(coming_, work_);
            momentum_ += work_ / h;
        }
        work_ = load_.before(report.t, h);
        stiffness_.add(-1, next_.u(), work_);
        momentum_ += h / 2 * work_;
        if (problem_.D) {
            velocity_.solve_mass(h / 2, momentum_);
            free_ = momentum_;
            problem_.M->multiply(free_, momentum_);
        }
        const ContactReport impact = velocity_.project(now_, momentum_, h, next_);
        if (closed) {
            report.impact = impact;
            report.outcome = impact.outcome;
            if (report.outcome != Outcome::converged) return report;
            next_.lambda += coming_ / (h * h);
        }
        closing_.swap(coming_);
        end_force(report.t);
        next_.step = report.step;
        std::swap(now_, next_);
        return report;
    }

private:
    void begin() {
        force_ = load_.after(grid_.t0, grid_.dt);
        stiffness_.add(-1, now_.u(), force_);
        if (problem_.D) problem_.D->multiply(now_.v(), force_, -1, 1);
    }

    /// momentum_ = M v0 + h/2 force, work_ = M u0 + h momentum_
    void kick_and_drift() {
        const double h = grid_.dt;
        if (const Vector* mass = problem_.M->diagonal_entries()) {
            momentum_ = mass->cwiseProduct(now_.v()) + h / 2 * force_;
            work_ = mass->cwiseProduct(now_.u()) + h * momentum_;
            return;
        }
        momentum_ = h / 2 * force_;
        problem_.M->multiply(now_.v(), momentum_, 1, 1);
        work_ = h * momentum_;
        problem_.M->multiply(now_.u(), work_, 1, 1);
    }

    /// force_ = f - K u - D v at the end of the step, right limit; work_ holds f1 - K u1.
    void end_force(double t) {
        force_.swap(work_);
        if (problem_.D) problem_.D->multiply(next_.v(), force_, -1, 1);
        if (!load_.jumps(t, grid_.dt)) return;
        force_ += load_.after(t, grid_.dt);
        force_ -= load_.before(t, grid_.dt);
    }

    Shared<ContactProblem> owned_;
    const ContactProblem& problem_ = *owned_;
    TimeGrid grid_;
    StageSolver stages_;
    JumpingLoad load_;
    RepeatedProduct stiffness_;
    std::shared_ptr<PreparedContact> mass_;
    VelocityProjection velocity_;
    State now_, next_;  // after a step next_ is the one before
    Vector force_, momentum_, work_, free_, bound_;
    Vector closing_, coming_;  // position multipliers of the last step and of this one
    Vector scratch_;
};

void check_problem(const ContactProblem& problem) {
    if (!problem.second_order()) throw InputError("CentralDifference: the problem has no M, expected one");
    if (problem.r) throw InputError("CentralDifference: the problem has an r, expected linear internal forces");
    if (const Vector* mass = problem.M->diagonal_entries(); mass && !(mass->array() > 0).all())
        throw InputError("CentralDifference: M has an unknown without mass, expected positive entries");
}

}  // namespace

CentralDifference::CentralDifference(double restitution) : restitution_(restitution) {
    check_restitution("CentralDifference", restitution);
}

std::string CentralDifference::name() const {
    return WithOptions("central-difference").add("e", restitution_).text();
}

double CentralDifference::largest_step(const ContactProblem& problem, const ContactWorkspace& workspace,
                                       double wanted) {
    check_problem(problem);
    constexpr double rounding = 1e-10;
    double safe = 0;
    if (const Vector* mass = problem.M->diagonal_entries()) {
        safe = 2 / std::sqrt(circles(problem.K, *mass));
        if (wanted <= safe * (1 + rounding)) return std::max(safe, wanted);
    }
    VelocityProjection velocity(Shared<ContactProblem>::borrowed(problem), workspace, 0, true);
    return std::max(safe, 2 / std::sqrt(lanczos(problem, velocity)));
}

std::unique_ptr<Run> CentralDifference::start(const Shared<ContactProblem>& problem, const TimeGrid& grid,
                                              const ContactWorkspace& workspace) const {
    require_contact_rows("CentralDifference", *problem);
    const double largest = largest_step(*problem, workspace, grid.dt);
    if (!(grid.dt <= largest))
        throw InputError("CentralDifference: dt is " + shown(grid.dt) + ", expected at most " + shown(largest) +
                         " = 2 / the largest natural frequency");
    return std::make_unique<CentralRun>(problem, grid, workspace, restitution_);
}

}  // namespace tact
