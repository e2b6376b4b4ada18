#include "tact/lib/stage.hpp"

#include <algorithm>
#include <string>

namespace tact {

State::State(const ContactProblem& problem, double t0) : t(t0), n(problem.size()) {
    y = Vector::Zero(problem.second_order() ? 2 * n : n);
    if (problem.u0.size() == n) u() = problem.u0;
    if (problem.second_order()) v() = problem.v0;
    lambda = Vector::Zero(problem.constraints());
}

struct ContactWorkspace::Entry {
    std::optional<Matrix> M, D;  // copies keep the storage, and so the key, alive
    Matrix K, B;
    double a;
    std::shared_ptr<PreparedContact> contact;

    bool matches(const ContactProblem& p, double a_) const {
        const auto same = [](const std::optional<Matrix>& x, const std::optional<Matrix>& y) {
            return x.has_value() == y.has_value() && (!x || x->same_storage(*y));
        };
        return a == a_ && K.same_storage(p.K) && B.same_storage(p.B) && same(M, p.M) && same(D, p.D);
    }
};

ContactWorkspace::ContactWorkspace(std::shared_ptr<const ContactSolver> solver, std::size_t capacity)
    : solver_(std::move(solver)), capacity_(std::max<std::size_t>(capacity, 1)) {
    if (!solver_) throw InputError("ContactWorkspace: the contact solver is null");
}
ContactWorkspace::~ContactWorkspace() = default;
ContactWorkspace::ContactWorkspace(ContactWorkspace&&) noexcept = default;
ContactWorkspace& ContactWorkspace::operator=(ContactWorkspace&&) noexcept = default;

std::shared_ptr<PreparedContact> ContactWorkspace::prepared(const ContactProblem& p, double a) {
    const auto found =
        std::find_if(entries_.begin(), entries_.end(), [&](const auto& entry) { return entry->matches(p, a); });
    if (found != entries_.end()) {
        std::rotate(entries_.begin(), found, found + 1);
        return entries_.front()->contact;
    }
    Matrix A = p.K;
    if (p.D && a != 0) A = combine(a, *p.D, 1, A);
    if (p.M && a != 0) A = combine(a * a, *p.M, 1, A);
    std::shared_ptr<PreparedContact> contact = solver_->prepare(A, p.B);
    if (entries_.size() == capacity_) entries_.pop_back();
    entries_.insert(entries_.begin(), std::make_unique<Entry>(Entry{p.M, p.D, p.K, p.B, a, std::move(contact)}));
    return entries_.front()->contact;
}

StageSolver::StageSolver(const ContactProblem& problem, ContactWorkspace& workspace)
    : problem_(problem),
      workspace_(workspace),
      load_(problem.size()),
      gap_(problem.constraints()),
      rhs_(problem.size()),
      work_(problem.size()),
      scratch_(std::max(problem.f.modes.cols(), problem.c.modes.cols())) {
    if (problem.f.constant()) problem.f.evaluate(0, Side::right, scratch_, load_);
    if (problem.constraints() > 0 && problem.c.constant()) problem.c.evaluate(0, Side::right, scratch_, gap_);
}

ContactReport StageSolver::solve(const Stage& stage, State& state) {
    const ContactProblem& p = problem_;
    if (!prepared_ || prepared_a_ != stage.a) {
        prepared_ = workspace_.prepared(p, stage.a);
        prepared_a_ = stage.a;
    }
    if (!p.f.constant()) p.f.evaluate(stage.t, Side::right, scratch_, load_);
    if (p.constraints() > 0 && !p.c.constant()) p.c.evaluate(stage.t, Side::right, scratch_, gap_);
    if (p.second_order()) {
        work_ = stage.b_v + stage.a * stage.b_u;
        rhs_ = load_;
        p.M->multiply(work_, rhs_, -1, 1);
        if (p.D) p.D->multiply(stage.b_u, rhs_, -1, 1);
    } else if (p.D) {
        rhs_ = load_;
        p.D->multiply(stage.b_u, rhs_, -1, 1);
    }
    const Vector& b = p.is_static() ? load_ : rhs_;
    const ContactReport report = prepared_->solve(b, gap_, ContactPoint{state.u(), state.lambda});
    if (report.outcome == Outcome::converged) {
        if (p.second_order()) state.v() = stage.a * state.u() + stage.b_u;
        state.t = stage.t;
    }
    return report;
}

StaticSolution solve_static(const ContactProblem& problem, ContactWorkspace& workspace, const StaticSolution* guess) {
    if (!problem.is_static())
        throw InputError("solve_static: the problem has an M or a D, expected neither; use an integrator");
    StageSolver stages(problem, workspace);
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
