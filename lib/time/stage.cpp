#include "stage.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "../algebra/empty_rows.hpp"
#include "indefinite.hpp"
#include "newton.hpp"

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

std::unique_ptr<PreparedContact> prepare_contact(const ContactSolver& solver, const Matrix& A,
                                                 const ContactProblem& problem) {
    return problem.contact_only() ? solver.prepare(A, problem.B) : solver.prepare_rows(A, problem.B);
}

struct ContactWorkspace::Entry {
    std::optional<Matrix> M, D;  // copies keep the storage, and so the key, alive
    Matrix K, B;
    Combination combination;
    bool contact_only;
    std::shared_ptr<PreparedContact> contact;

    bool matches(const ContactProblem& p, const Combination& other) const {
        const auto same = [](const std::optional<Matrix>& x, const std::optional<Matrix>& y) {
            return x.has_value() == y.has_value() && (!x || x->same_storage(*y));
        };
        return combination == other && contact_only == p.contact_only() && K.same_storage(p.K) &&
               B.same_storage(p.B) && same(M, p.M) && same(D, p.D);
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
    std::shared_ptr<PreparedContact> contact;
    try {
        contact = prepare_contact(*kept_->solver, combined(p, combination), p);
    } catch (const std::exception& refusal) {
        const std::string why = why_indefinite(p, combination);
        if (why.empty()) throw;
        throw NumericalError(why + " (" + refusal.what() + ")");
    }
    if (entries.size() == kept_->capacity) entries.pop_back();
    entries.insert(entries.begin(), std::make_unique<Entry>(Entry{p.M, p.D, p.K, p.B, combination, p.contact_only(),
                                                                  std::move(contact)}));
    return entries.front()->contact;
}

StageSolver::StageSolver(Shared<ContactProblem> problem, ContactWorkspace workspace)
    : owned_(std::move(problem)),
      workspace_(std::move(workspace)),
      load_(problem_.size()),
      gap_(problem_.constraints()),
      rhs_(problem_.size()),
      work_(problem_.size()),
      scratch_(std::max({problem_.f.mode_count(), problem_.c.mode_count(),
                         problem_.c_up ? problem_.c_up->mode_count() : Index{0}})) {
    if (problem_.f.constant()) {
        problem_.f.evaluate(0, Side::right, scratch_, load_);
        load_fails_ = !load_.allFinite();
    }
    if (problem_.c_up) upper_.resize(problem_.constraints());
    if (problem_.constraints() > 0 && problem_.c.constant()) {
        problem_.c.evaluate(0, Side::right, scratch_, gap_);
        gap_fails_ = !(gap_.array() < infinity).all();
    }
    if (problem_.c_up && problem_.c_up->constant()) {
        problem_.c_up->evaluate(0, Side::right, scratch_, upper_);
        upper_fails_ = !(upper_.array() > -infinity).all();
    }
    if (problem_.r) newton_ = std::make_unique<NewtonSolver>(problem_, workspace_);
}

StageSolver::~StageSolver() = default;

const Vector& StageSolver::load(double t, Side side) {
    if (!problem_.f.constant()) {
        problem_.f.evaluate(t, side, scratch_, load_);
        // Modes are finite.
        load_fails_ =
            problem_.f.is_function() ? !load_.allFinite() : !scratch_.head(problem_.f.mode_count()).allFinite();
    }
    return load_;
}

void StageSolver::read_gap(double t) {
    if (problem_.constraints() == 0) return;
    if (!problem_.c.constant()) {
        problem_.c.evaluate(t, Side::right, scratch_, gap_);
        gap_fails_ = !(gap_.array() < infinity).all();
    }
    if (problem_.c_up && !problem_.c_up->constant()) {
        problem_.c_up->evaluate(t, Side::right, scratch_, upper_);
        upper_fails_ = !(upper_.array() > -infinity).all();
    }
}

RowBounds StageSolver::rows() const {
    const auto given = [](const Vector& v) { return v.size() > 0 ? &v : nullptr; };
    return {gap_, given(upper_), given(problem_.force_lo), given(problem_.force_up)};
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
    read_gap(t);
    ContactReport report;
    report.outcome = Outcome::not_finite;
    if (!load_fails_ && !gap_fails_ && !upper_fails_) {
        if (newton_) {
            report = newton_->solve(combination, rhs, rows(), point);
        } else {
            if (!prepared_ || !(combination_ == combination)) {
                prepared_ = workspace_.prepared(p, combination);
                combination_ = combination;
            }
            report = prepared_->solve_rows(rhs, rows(), point);
        }
    }
    if (report.outcome != Outcome::converged) explain(combination, t, rhs, report);
    return report;
}

/// Off the good path: what is not finite, or which matrix is at fault.
void StageSolver::explain(const Combination& combination, double t, const ConstVectorRef& rhs,
                          ContactReport& report) {
    const auto not_finite = [&](const char* name, const ConstVectorRef& x, bool allows_minus_infinity) {
        for (Index i = 0; i < x.size() && report.detail.empty(); ++i) {
            if (std::isfinite(x[i]) || (allows_minus_infinity && x[i] == -infinity)) continue;
            std::ostringstream text;
            text << name << " is " << x[i] << " in entry " << i;
            report.detail = text.str();
        }
    };
    if (report.detail.empty()) {
        not_finite("the load f(t)", load_, false);
        not_finite("the gap c(t)", gap_, true);
        not_finite("the right-hand side, of earlier states,", rhs, false);
        if (!report.detail.empty()) report.outcome = Outcome::not_finite;
    }
    if (report.outcome == Outcome::not_finite) {
        std::ostringstream text;
        text << report.detail << " at t = " << t;
        report.detail = text.str();
    } else if (report.detail.empty()) {
        report.detail = why_indefinite(problem_, combination);
    }
}

StaticSolution solve_static(const ContactProblem& problem, const ContactWorkspace& workspace,
                            const StaticSolution* guess) {
    if (!problem.is_static())
        throw InputError("solve_static: the problem has an M or a D, expected neither; use an integrator");
    validate(problem);
    StageSolver stages(Shared<ContactProblem>::borrowed(problem), workspace);
    State state(problem);
    if (guess && guess->u.size() == state.y.size()) state.y = guess->u;
    if (guess && guess->lambda.size() == state.lambda.size()) state.lambda = guess->lambda;
    const Vector zero = Vector::Zero(problem.size());
    StaticSolution solution;
    solution.report = stages.solve(Stage{0, 0, zero, zero}, state);
    if (const std::string row = contradiction_of_empty_row(solution.report, problem.B, problem.c.at(0)); !row.empty())
        throw InputError("ContactProblem: " + row);
    solution.u = std::move(state.y);
    solution.lambda = std::move(state.lambda);
    return solution;
}

}  // namespace tact
