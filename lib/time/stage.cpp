#include "stage.hpp"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

namespace tact {

State::State(const ContactProblem& problem, double t0) : t(t0), n(problem.size()) {
    y = Vector::Zero(problem.second_order() ? 2 * n : n);
    if (problem.u0.size() == n) u() = problem.u0;
    if (problem.second_order()) v() = problem.v0;
    lambda = Vector::Zero(problem.constraints());
}

Matrix combined(const ContactProblem& p, const Combination& c) {
    if (c.stiffness == 0 && p.M && c.mass == 1 && (!p.D || c.damping == 0)) return *p.M;
    std::optional<Matrix> A;
    const auto add = [&A](double factor, const Matrix& X) {
        if (factor == 0) return;
        if (!A)
            A = factor == 1 ? X : scaled(factor, X);
        else
            A = combine(factor, X, 1, *A);
    };
    add(c.stiffness, p.K);
    if (p.D) add(c.damping, *p.D);
    if (p.M) add(c.mass, *p.M);
    return A ? *A : scaled(0, p.K);
}

struct ContactWorkspace::Entry {
    std::optional<Matrix> M, D;  // copies keep the storage, and so the key, alive
    Matrix K, B;
    Combination combination;
    std::shared_ptr<PreparedContact> contact;

    bool matches(const ContactProblem& p, const Combination& other) const {
        const auto same = [](const std::optional<Matrix>& x, const std::optional<Matrix>& y) {
            return x.has_value() == y.has_value() && (!x || x->same_storage(*y));
        };
        return combination == other && K.same_storage(p.K) && B.same_storage(p.B) && same(M, p.M) && same(D, p.D);
    }
};

struct ContactWorkspace::Kept {
    Shared<ContactSolver> solver;
    std::size_t capacity;
    std::vector<std::unique_ptr<Entry>> entries = {};  // most recent first
};

ContactWorkspace::ContactWorkspace(Shared<ContactSolver> solver, std::size_t capacity) {
    if (!solver) throw InputError("ContactWorkspace: the contact solver is null");
    kept_ = std::make_shared<Kept>(Kept{std::move(solver), std::max<std::size_t>(capacity, 1)});
}

const ContactSolver& ContactWorkspace::solver() const { return *kept_->solver; }

std::shared_ptr<PreparedContact> ContactWorkspace::prepared(const ContactProblem& p,
                                                            const Combination& combination) const {
    auto& entries = kept_->entries;
    const auto found = std::find_if(entries.begin(), entries.end(),
                                    [&](const auto& entry) { return entry->matches(p, combination); });
    if (found != entries.end()) {
        std::rotate(entries.begin(), found, found + 1);
        return entries.front()->contact;
    }
    std::shared_ptr<PreparedContact> contact = kept_->solver->prepare(combined(p, combination), p.B);
    if (entries.size() == kept_->capacity) entries.pop_back();
    entries.insert(entries.begin(),
                   std::make_unique<Entry>(Entry{p.M, p.D, p.K, p.B, combination, std::move(contact)}));
    return entries.front()->contact;
}

StageSolver::StageSolver(Shared<ContactProblem> problem, ContactWorkspace workspace)
    : owned_(std::move(problem)),
      workspace_(std::move(workspace)),
      load_(problem_.size()),
      gap_(problem_.constraints()),
      rhs_(problem_.size()),
      work_(problem_.size()),
      scratch_(std::max(problem_.f.modes.cols(), problem_.c.modes.cols())) {
    if (problem_.f.constant()) problem_.f.evaluate(0, Side::right, scratch_, load_);
    if (problem_.constraints() > 0 && problem_.c.constant()) problem_.c.evaluate(0, Side::right, scratch_, gap_);
}

const Vector& StageSolver::load(double t, Side side) {
    if (!problem_.f.constant()) problem_.f.evaluate(t, side, scratch_, load_);
    return load_;
}

ContactReport StageSolver::solve(const Stage& stage, State& state) {
    const ContactProblem& p = problem_;
    load(stage.t, Side::right);
    if (p.second_order()) {
        if (const Vector* mass = p.M->diagonal_entries()) {
            // One pass: at full size these vectors come from memory.
            rhs_ = load_ - mass->cwiseProduct(stage.b_v + stage.a * stage.b_u);
        } else {
            work_ = stage.b_v + stage.a * stage.b_u;
            rhs_ = load_;
            p.M->multiply(work_, rhs_, -1, 1);
        }
        if (p.D) p.D->multiply(stage.b_u, rhs_, -1, 1);
    } else if (p.D) {
        rhs_ = load_;
        p.D->multiply(stage.b_u, rhs_, -1, 1);
    }
    const Vector& rhs = p.is_static() ? load_ : rhs_;
    ContactReport report = solve(Combination{stage.a * stage.a, stage.a, 1}, stage.t, rhs, {state.u(), state.lambda});
    if (report.outcome == Outcome::converged) {
        if (p.second_order()) state.v() = stage.a * state.u() + stage.b_u;
        state.t = stage.t;
    }
    return report;
}

ContactReport StageSolver::solve(const Combination& combination, double t, const ConstVectorRef& rhs,
                                 ContactPoint point) {
    const ContactProblem& p = problem_;
    if (p.constraints() > 0 && !p.c.constant()) p.c.evaluate(t, Side::right, scratch_, gap_);
    if (p.r) return newton(combination, rhs, point);
    if (!prepared_ || !(combination_ == combination)) {
        prepared_ = workspace_.prepared(p, combination);
        combination_ = combination;
    }
    return prepared_->solve(rhs, gap_, point);
}

ContactReport StageSolver::newton(const Combination& combination, const ConstVectorRef& rhs, ContactPoint point) {
    constexpr int most_iterations = 25;
    // Newton's error is about the square of its last change: this leaves it at rounding.
    constexpr double small_change = 1e-9;
    const Matrix A = combined(problem_, combination);
    Vector u = point.u, lambda = point.lambda, next, b;
    ContactReport report;
    int iterations = 0;
    for (int k = 0; k < most_iterations; ++k) {
        // r(u_k+1) = r(u_k) + r'(u_k)(u_k+1 - u_k)
        const Matrix tangent = problem_.r->tangent(u);
        b.resize(u.size());
        problem_.r->force(u, b);
        tangent.multiply(u, b, 1, -1);
        b += rhs;
        next = u;
        report = workspace_.solver().prepare(combine(1, tangent, 1, A), problem_.B)->solve(b, gap_, {next, lambda});
        report.iterations = iterations += report.iterations;
        if (report.outcome != Outcome::converged) return report;
        const double change = (next - u).lpNorm<Eigen::Infinity>();
        const double size = next.lpNorm<Eigen::Infinity>();
        u.swap(next);
        if (!(change > small_change * size)) {
            point.u = u;
            point.lambda = lambda;
            return report;
        }
    }
    report.outcome = Outcome::iteration_limit;
    return report;
}

StaticSolution solve_static(const ContactProblem& problem, const ContactWorkspace& workspace,
                            const StaticSolution* guess) {
    if (!problem.is_static())
        throw InputError("solve_static: the problem has an M or a D, expected neither; use an integrator");
    StageSolver stages(Shared<ContactProblem>::borrowed(problem), workspace);
    State state(problem);
    if (guess && guess->u.size() == state.y.size()) state.y = guess->u;
    if (guess && guess->lambda.size() == state.lambda.size()) state.lambda = guess->lambda;
    const Vector zero = Vector::Zero(problem.size());
    StaticSolution solution;
    solution.report = stages.solve(Stage{0, 0, zero, zero}, state);
    solution.u = std::move(state.y);
    solution.lambda = std::move(state.lambda);
    return solution;
}

}  // namespace tact
