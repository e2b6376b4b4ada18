#include "newton.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <sstream>
#include <utility>

namespace tact {
namespace {

/// The residual that the sparse strategies accept of one solve, and r where rounding leaves no smaller one.
constexpr double acceptable = 1e-10;
/// Of the load, some roundings: inertia makes b, and with it what an error of r does to the acceleration, as large as
/// 1 / dt^2. An iterative strategy leaves more than this, and r may add as much as that.
constexpr double sharp = 64 * std::numeric_limits<double>::epsilon();
constexpr int most_solves = 50;
/// More solves than this with one tangent cost more than a new tangent and the two or three solves after it.
constexpr double patience = 8;
/// Solves beyond one a stage that cost as much as a new tangent: with a sparse factor and its columns some forty.
constexpr double cost_of_tangent = 40;
/// Combinations of M, D and K that are kept, as many as a ContactWorkspace keeps.
constexpr std::size_t most_frozen = 4;

std::string entry_that_is_not_finite(const char* name, const Vector& x) {
    const auto at = std::find_if(x.begin(), x.end(), [](double entry) { return !std::isfinite(entry); });
    if (at == x.end()) return {};
    std::ostringstream text;
    text << name << " is " << *at << " in entry " << at - x.begin() << ", expected finite";
    return text.str();
}

}  // namespace

/// The contact solver of one combination, and the tangent in it.
struct NewtonSolver::Frozen {
    Combination combination;
    Matrix A;
    KktCertificate certificate;
    std::shared_ptr<PreparedContact> contact = {};
    std::optional<Matrix> tangent = {};  ///< nothing: T = 0
    bool owned = false;                  ///< `contact` is this solver's alone, so that it may be updated
    double spent = 0;                    ///< solves beyond one a stage since the last tangent
    double budget = cost_of_tangent;     ///< doubled by each tangent that was bought with it
};

NewtonSolver::NewtonSolver(const ContactProblem& problem, ContactWorkspace workspace)
    : problem_(problem),
      workspace_(std::move(workspace)),
      force_(problem.size()),
      next_force_(problem.size()),
      load_(problem.size()),
      work_(problem.size()),
      product_(problem.size()) {}

NewtonSolver::~NewtonSolver() = default;

ContactReport NewtonSolver::solve(const Combination& combination, const ConstVectorRef& b, const RowBounds& rows,
                                  ContactPoint point) {
    u_ = point.u;
    moved_ = false;
    start_lambda_ = point.lambda;
    problem_.r->force(u_, force_);
    fault_.clear();
    fresh_ = false;
    Frozen* at = frozen(combination);
    if (at && at->spent >= at->budget) {
        at->budget *= 2;
        renew(*at);
    }
    ContactReport report;
    if (fault_.empty()) report = iterate(*at, b, rows, point);
    if (!fault_.empty()) {
        report.outcome = Outcome::not_finite;
        report.detail = fault_;
    }
    if (report.outcome != Outcome::converged) {
        point.u = moved_ ? start_u_ : u_;
        point.lambda = start_lambda_;
    }
    return report;
}

/// Begins at u_ and force_, with point as the guess; leaves the last solve in point.
ContactReport NewtonSolver::iterate(Frozen& at, const ConstVectorRef& b, const RowBounds& rows, ContactPoint point) {
    const double loads = b.lpNorm<Eigen::Infinity>();
    // The smallest change so far. A first step from afar may lead further away: there r(u) alone makes it about 1.
    double before = 0.5;
    bool moved = false;
    int iterations = 0;
    for (int solves = 1;; ++solves) {
        load_ = b - force_;
        if (at.tangent) at.tangent->multiply(u_, load_, 1, 1);
        ContactReport report = at.contact->solve_rows(load_, rows, point);
        report.iterations = iterations += report.iterations;
        if (report.outcome != Outcome::converged) {
            fault_ = entry_that_is_not_finite("r(u)", force_);
            if (!fault_.empty()) return report;
            if (solves == most_solves || (fresh_ && !at.tangent)) {
                report.kkt = at.certificate(b, rows, point.u, point.lambda, force_);
                return report;
            }
            // With the tangent of this very point A + T may be indefinite: A alone need not be.
            if (fresh_)
                leave_out_tangent(at);
            else
                renew(at);
            if (!fault_.empty()) return report;
            continue;
        }
        problem_.r->force(point.u, next_force_);
        const double left = std::max(sharp, report.kkt.absolute.stationarity / std::max(loads, underflow));
        const double change = change_of_load(at, loads, point.u);
        const bool falls = change < before;
        const bool fast = moved ? change * std::pow(change / before, patience) <= left : falls;
        const bool done = change <= left || (!fast && fresh_ && change <= acceptable && change >= 0.5 * before);
        if (done || solves == most_solves) {
            report.kkt = at.certificate(b, rows, point.u, point.lambda, next_force_);
            at.spent += solves - 1;
            if (done && report.kkt.stationarity <= acceptable) return report;
            report.outcome = done ? Outcome::inaccurate : Outcome::iteration_limit;
            report.detail = what_is_wrong(report, loads, solves, point.u);
            return report;
        }
        if (falls || !fresh_) {
            if (falls) {
                move_to(point.u);
                before = change;
                moved = true;
            }
            fresh_ = false;
            if (!fast) renew(at);
        } else {
            shorten_step(at, b, point.u);
            if (fault_.empty()) renew(at);
        }
        if (!fault_.empty()) return report;
    }
}

/// r(u) - r(u_) - T (u - u_): by so much the load of the solve that gave u differs from that of the stage; over the largest
/// of b and r(u). Unlike |A||u|, which the residual is measured by, these do not hide a small force behind large ones that
/// cancel.
double NewtonSolver::change_of_load(const Frozen& at, double loads, const ConstVectorRef& u) {
    if (at.tangent) {
        work_ = u - u_;
        at.tangent->multiply(work_, product_);
    }
    // In one pass: at full size vectors come from memory. The sum keeps every NaN, a comparison drops it.
    double change = 0, largest = loads, sum = 0;
    for (Index i = 0; i < u.size(); ++i) {
        const double here = next_force_[i] - force_[i] - (at.tangent ? product_[i] : 0.0);
        change = std::max(change, std::abs(here));
        largest = std::max(largest, std::abs(next_force_[i]));
        sum += std::abs(here);
    }
    if (!std::isfinite(sum)) return infinity;
    return change == 0 ? 0 : change / std::max(largest, underflow);
}

NewtonSolver::Frozen* NewtonSolver::frozen(const Combination& combination) {
    const auto found =
        std::find_if(frozen_.begin(), frozen_.end(), [&](const auto& at) { return at->combination == combination; });
    if (found != frozen_.end()) {
        std::rotate(frozen_.begin(), found, found + 1);
        return frozen_.front().get();
    }
    Matrix A = combined(problem_, combination);
    KktCertificate certificate(A, problem_.B);
    auto at = std::make_unique<Frozen>(Frozen{combination, std::move(A), std::move(certificate)});
    const Matrix tangent = problem_.r->tangent(u_);
    if (outweighed_by_inertia(combination, tangent)) {
        at->contact = workspace_.prepared(problem_, combination);
    } else {
        // What is no longer needed has the right pattern mostly.
        if (frozen_.size() == most_frozen && frozen_.back()->owned) {
            at->contact = std::move(frozen_.back()->contact);
            at->owned = true;
        }
        put_in(*at, tangent);
        if (!fault_.empty()) return nullptr;
    }
    if (frozen_.size() == most_frozen) frozen_.pop_back();
    frozen_.insert(frozen_.begin(), std::move(at));
    return frozen_.front().get();
}

void NewtonSolver::renew(Frozen& at) { put_in(at, problem_.r->tangent(u_)); }

/// Where A + T is singular or indefinite the solver keeps the tangent that it has, or none.
void NewtonSolver::put_in(Frozen& at, const Matrix& tangent) {
    if (!tangent.all_finite()) {
        fault_ = "the tangent of r has an entry that is NaN or infinite, expected finite entries";
        return;
    }
    fresh_ = true;
    at.spent = 0;
    const Matrix A = combine(1, tangent, 1, at.A);
    try {
        if (!at.owned || !at.contact->update(A)) at.contact = prepare_contact(workspace_.solver(), A, problem_);
        at.owned = true;
        at.tangent = tangent;
    } catch (const NumericalError&) {
        if (!at.tangent) leave_out_tangent(at);
    } catch (const InputError&) {
        if (!(A.main_diagonal().array() < 0).any()) throw;
        if (!at.tangent) leave_out_tangent(at);
    }
}

void NewtonSolver::leave_out_tangent(Frozen& at) {
    at.contact = workspace_.prepared(problem_, at.combination);
    at.owned = false;
    at.tangent.reset();
}

/// Whether T = 0 leaves the iteration fast: the inertia of every row outweighs its stiffness r'.
bool NewtonSolver::outweighed_by_inertia(const Combination& combination, const Matrix& tangent) const {
    constexpr double share = 0.02;  // of the error is left by an iteration: six or seven solves at most
    Vector inertia = Vector::Zero(problem_.size());
    if (problem_.M) inertia += combination.mass * problem_.M->main_diagonal();
    if (problem_.D) inertia += combination.damping * problem_.D->main_diagonal();
    return (tangent.main_diagonal().array().abs() <= share * inertia.array()).all();
}

/// From u_ towards `next` to where A u + r(u) - b no longer works along the way: there the potential is least, where there is
/// one. The whole step where the work is negative to its end.
void NewtonSolver::shorten_step(const Frozen& at, const ConstVectorRef& b, VectorRef next) {
    work_ = next - u_;
    at.A.multiply(u_, product_);
    const double start = work_.dot(product_ + force_ - b);
    at.A.multiply(work_, product_);
    const double slope = work_.dot(product_);
    double low = 0, high = 1, length = 1;
    for (int trial = 0; trial < 40; ++trial) {
        const double work = start + length * slope + work_.dot(next_force_ - force_);
        const bool finite = std::isfinite(work);
        if (finite && (start >= 0 || std::abs(work) <= 0.1 * std::abs(start) || (work < 0 && length == 1))) break;
        (finite && work < 0 ? low : high) = length;
        length = 0.5 * (low + high);
        load_ = u_ + length * work_;
        problem_.r->force(load_, next_force_);
    }
    fault_ = entry_that_is_not_finite("r(u)", next_force_);
    if (!fault_.empty()) return;
    if (length < 1) next = u_ + length * work_;
    move_to(next);
}

void NewtonSolver::move_to(const ConstVectorRef& next) {
    if (!std::exchange(moved_, true)) start_u_.swap(u_);
    u_ = next;
    force_.swap(next_force_);
}

/// For the report: how large the residual is beside b and r, and whether the tangent is at fault.
std::string NewtonSolver::what_is_wrong(const ContactReport& report, double loads, int solves,
                                        const ConstVectorRef& u) {
    const double forces = std::max(loads, next_force_.lpNorm<Eigen::Infinity>());
    std::ostringstream text;
    text << "with r(u): after " << solves << " contact solves the largest residual is "
         << report.kkt.absolute.stationarity << ", the largest entry of the load and of r(u) " << forces;
    // The derivative of r along the last step, by a difference, against the tangent.
    work_ = u - u_;
    const double size = work_.lpNorm<Eigen::Infinity>();
    if (!(size > 0)) return text.str();
    const double h = 1e-6 * std::max(u_.lpNorm<Eigen::Infinity>(), size) / size;
    problem_.r->tangent(u_).multiply(work_, product_);
    load_ = u_ + h * work_;
    problem_.r->force(load_, next_force_);
    const Vector slope = (next_force_ - force_) / h;
    const double difference = (slope - product_).lpNorm<Eigen::Infinity>();
    const double by_tangent = product_.lpNorm<Eigen::Infinity>(), by_force = slope.lpNorm<Eigen::Infinity>();
    if (!(difference <= 0.01 * std::max(by_tangent, by_force)))
        text << "; the tangent of r is not its derivative: along the last step it gives at most " << by_tangent
             << ", differences of r give " << by_force;
    return text.str();
}

}  // namespace tact
