#include "saddle_active_set.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <set>

#include "balance.hpp"

namespace tact {
namespace {

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

constexpr double dependence = SchurFactor::dependence;
constexpr double balance_rounding = 1e-11;  // of the terms of a mode's balance
constexpr double forgivable = 1e4;          // allowances that a dependent row may stay violated by

}  // namespace

SaddleActiveSet::Report SaddleActiveSet::solve(const Problem& p, Vector& lambda, Vector& tau, Vector& w) {
    Report report;
    forgiven_.clear();
    postponed_.clear();
    report.outcome = primal_dual(p, lambda, tau, w, report);
    if (report.outcome != Outcome::converged) {
        report.repeated = true;
        report.outcome = dual(p, lambda, tau, w, report);
    }
    if (report.outcome != Outcome::converged && report.outcome != Outcome::unbounded)
        move_rows_apart(p, lambda, tau, w, report);
    if (report.outcome != Outcome::converged) return report;
    drop_rounding(p, lambda, tau, w);
    std::vector<Index> pressed;
    for (Index i = 0; i < lambda.size(); ++i)
        if (lambda[i] > 0) pressed.push_back(i);
    if (factor_.size() != static_cast<Index>(pressed.size())) {
        factor_.change(p.S, pressed);
        take_modes(p);
    }
    return report;
}

/// Where many rows meet in one point rounding decides ties: it may leave a set without a regular exchange, or make rows that
/// just meet exclude each other. The rows are moved apart, and the rows in contact there are tried where they are.
void SaddleActiveSet::move_rows_apart(const Problem& p, Vector& lambda, Vector& tau, Vector& w, Report& report) {
    const Index m = p.g.size();
    if (m == 0) return;
    const Vector certificate = certificate_;
    for (const double apart : {1e-10, 1e-8, 1e-6}) {
        const Vector g = p.g - apart * p.g.lpNorm<Eigen::Infinity>() * Vector::LinSpaced(m, 1, 2).cwiseSqrt();
        const Problem moved{p.S, p.G, p.stiffness, p.e, p.e_size, g, p.allowance};
        forgiven_.clear();
        postponed_.clear();
        Vector there = Vector::Zero(m);
        if (primal_dual(moved, there, tau, w, report) != Outcome::converged &&
            dual(moved, there, tau, w, report) != Outcome::converged)
            continue;
        if (primal_dual(p, there, tau, w, report) != Outcome::converged) continue;
        lambda = there;
        report.outcome = Outcome::converged;
        return;
    }
    certificate_ = certificate;
}

/// Forces that are rounding of the gaps leave if no gap and no balance misses them. In a motion that needs no force all are.
void SaddleActiveSet::drop_rounding(const Problem& p, Vector& lambda, const Vector& tau, Vector& w) const {
    const Index m = p.g.size();
    const double least = m > 0 ? 1e-12 * p.g.lpNorm<Eigen::Infinity>() : 0;
    Vector small = (lambda.array() <= least).select(lambda, 0.0);
    if ((small.array() == 0).all()) return;
    const Vector kept = lambda - small;
    const auto G = p.G.topRows(m);
    const Vector gap = p.S.topLeftCorner(m, m) * small;
    const Vector without = G.transpose() * kept - p.stiffness.cwiseProduct(tau) - p.e;
    const Vector with = without + G.transpose() * small;
    const Vector size = p.e_size + G.cwiseAbs().transpose() * kept + p.stiffness.cwiseProduct(tau.cwiseAbs());
    if ((gap.array().abs() > p.allowance.array() + 4 * noise_).any() ||
        (without.array().abs() > with.array().abs().max(balance_rounding * size.array())).any())
        return;
    lambda = kept;
    w -= gap;
}

Outcome SaddleActiveSet::primal_dual(const Problem& p, Vector& lambda, Vector& tau, Vector& w, Report& report) {
    const Index m = p.g.size();
    std::vector<Index> wanted;
    for (Index i = 0; i < m; ++i)
        if (lambda[i] > 0) wanted.push_back(i);
    if (wanted.empty())
        for (Index i = 0; i < m; ++i) wanted.push_back(i);
    std::set<std::vector<Index>> seen;
    // On meshes three to eight sets do, growing with the logarithm of their number of rows.
    constexpr int limit = 40;
    while (static_cast<int>(seen.size()) < limit && seen.insert(wanted).second) {
        ++report.iterations;
        factor_.change(p.S, wanted);
        take_modes(p);
        solve_equations(p, tau);
        // Rows that depend on others to rounding leave nothing but that.
        const double gap_size = m > 0 ? p.g.lpNorm<Eigen::Infinity>() : 0;
        spread(lambda);
        if (noise_ > 1e-10 * std::max(gap_size, m > 0 ? lambda.lpNorm<Eigen::Infinity>() : 0) ||
            !std::isfinite(noise_) || !(imbalance(p, tau) <= 1))
            return Outcome::cycling;
        gaps(p, tau, w);
        if (!held_) return Outcome::cycling;
        bool settled = true;
        wanted.clear();
        const double open = 4 * noise_;
        for (Index i = 0; i < m; ++i) {
            if (lambda[i] > open)
                wanted.push_back(i);
            else if (lambda[i] < -open)
                settled = false;
            else if (w[i] < -p.allowance[i] - open) {
                wanted.push_back(i);
                settled = false;
            }
        }
        if (!settled) continue;
        for (double& force : lambda)
            if (force <= open) force = 0;
        return Outcome::converged;
    }
    return Outcome::cycling;
}

Outcome SaddleActiveSet::start(const Problem& p, std::vector<Index>& rows) {
    std::vector<Index> free;
    for (Index j = 0; j < p.stiffness.size(); ++j)
        if (p.stiffness[j] == 0) free.push_back(j);
    rows.clear();
    if (free.empty()) return Outcome::converged;
    const DenseMatrix G = p.G.topRows(p.g.size())(Eigen::all, free);
    const Balance balanced = balance(G, p.e(free));
    const Vector size = p.e_size(free);
    if ((balanced.rest.array().abs() > balance_rounding * size.array()).any()) {
        certificate_ = Vector::Zero(p.stiffness.size());
        certificate_(free) = -balanced.rest;
        return Outcome::unbounded;
    }
    rows = balanced.rows;
    return complete(G, rows) ? Outcome::converged : Outcome::inaccurate;
}

void SaddleActiveSet::take_modes(const Problem& p) {
    const auto& rows = factor_.rows();
    Y_ = p.G(rows, Eigen::all);
    for (Index j = 0; j < Y_.cols(); ++j) factor_.solve_lower(Y_.col(j));
    H_ = Y_.transpose() * Y_;
    H_.diagonal() += p.stiffness;
    const Index k = H_.rows();
    const Eigen::LLT<DenseMatrix> factor(H_);
    holds_ = factor.info() == Eigen::Success &&
             (factor.matrixLLT().diagonal().array().square() > 1e-15 * H_.diagonal().array()).all();
    if (holds_) {
        inverse_ = factor.solve(DenseMatrix::Identity(k, k));
        return;
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(H_);
    const double least = k > 0 ? 1e-12 * eigen.eigenvalues()[k - 1] : 0;
    const Vector inverted = eigen.eigenvalues().unaryExpr([&](double h) { return h > least ? 1 / h : 0.0; });
    inverse_ = eigen.eigenvectors() * inverted.asDiagonal() * eigen.eigenvectors().transpose();
}

Vector SaddleActiveSet::modes_solved(const Vector& f) const {
    Vector x = inverse_ * f;
    x += inverse_ * (f - H_ * x);
    return x;
}

/// (q, e) := (lambda, tau) with S lambda + G tau = q, G'lambda - diag(stiffness) tau = e.
void SaddleActiveSet::solve_once(Vector& q, Vector& e) const {
    factor_.solve_lower(q);
    e = modes_solved(Y_.transpose() * q - e);
    q -= Y_ * e;
    factor_.solve_upper(q);
}

void SaddleActiveSet::solve_equations(const Problem& p, Vector& tau) {
    const auto& rows = factor_.rows();
    const DenseMatrix S = p.S(rows, rows), G = p.G(rows, Eigen::all);
    Vector lambda = p.g(rows);
    tau = p.e;
    solve_once(lambda, tau);
    noise_ = infinity;
    for (int pass = 0; pass < 3; ++pass) {
        Vector q = p.g(rows) - S * lambda - G * tau;
        Vector e = p.e - G.transpose() * lambda + p.stiffness.cwiseProduct(tau);
        solve_once(q, e);
        const double change = rows.empty() ? 0 : q.lpNorm<Eigen::Infinity>();
        if (!(change < noise_) && pass > 0) break;
        lambda += q;
        tau += e;
        noise_ = change;
        if (change <= 1e-16 * (rows.empty() ? 0 : lambda.lpNorm<Eigen::Infinity>())) break;
    }
    // One rounding of the largest force at least: the sums that balance it cannot tell less.
    if (!rows.empty()) noise_ = std::max(noise_, 1e-16 * lambda.lpNorm<Eigen::Infinity>());
    multiplier_.assign(lambda.begin(), lambda.end());
}

/// The largest |G'lambda - stiffness tau - e|, in what is allowed of it.
double SaddleActiveSet::imbalance(const Problem& p, const Vector& tau) const {
    Vector off = -p.e - p.stiffness.cwiseProduct(tau);
    Vector size = p.e_size + p.stiffness.cwiseProduct(tau).cwiseAbs();
    for (std::size_t i = 0; i < multiplier_.size(); ++i) {
        const auto row = p.G.row(factor_.rows()[i]).transpose();
        off += multiplier_[i] * row;
        size += std::abs(multiplier_[i]) * row.cwiseAbs();
    }
    double worst = 0;
    for (Index j = 0; j < off.size(); ++j)
        if (off[j] != 0) worst = std::max(worst, std::abs(off[j]) / (balance_rounding * size[j]));
    return worst;
}

void SaddleActiveSet::gaps(const Problem& p, const Vector& tau, Vector& w) {
    const Index m = p.g.size();
    w = p.G.topRows(m) * tau - p.g;
    for (std::size_t i = 0; i < multiplier_.size(); ++i) w += multiplier_[i] * p.S.col(factor_.rows()[i]).head(m);
    held_ = true;
    for (const Index row : factor_.rows()) {
        held_ &= std::abs(w[row]) <= p.allowance[row] + 8 * noise_;
        w[row] = 0;
    }
}

void SaddleActiveSet::spread(Vector& lambda) const {
    lambda.setZero();
    for (std::size_t i = 0; i < multiplier_.size(); ++i) lambda[factor_.rows()[i]] = multiplier_[i];
}

void SaddleActiveSet::solve_on_last_rows(const Problem& p, Vector& lambda, Vector& tau) {
    const auto& rows = factor_.rows();
    Vector q = p.g(rows);
    tau = p.e;
    solve_once(q, tau);
    lambda.setZero(p.g.size());
    for (std::size_t i = 0; i < rows.size(); ++i) lambda[rows[i]] = q[static_cast<Index>(i)];
}

Outcome SaddleActiveSet::dual(const Problem& p, Vector& lambda, Vector& tau, Vector& w, Report& report) {
    std::vector<Index> rows;
    if (const Outcome begun = start(p, rows); begun != Outcome::converged) return begun;
    factor_.rebuild(p.S, rows);
    take_modes(p);
    if (factor_.size() != static_cast<Index>(rows.size()) || !holds_) return Outcome::inaccurate;
    solve_equations(p, tau);
    for (double& force : multiplier_) force = std::max(force, 0.0);
    gaps(p, tau, w);
    const int limit = static_cast<int>(std::min<Index>(20 * p.g.size() + 1000, 10000000));
    int standing = 0;  // steps of length zero in a row
    while (true) {
        const bool by_number = standing > 10;
        const Index q = most_violated(p, w, by_number);
        if (q < 0 && !postponed_.empty()) return Outcome::inaccurate;
        if (q < 0) break;
        double moved = 0;
        const std::size_t waiting = postponed_.size();
        const Outcome end = enter(p, q, by_number, w, report, moved);
        if (end != Outcome::converged) return end;
        if (postponed_.size() == waiting) postponed_.clear();
        standing = moved > 0 ? 0 : standing + 1;
        solve_equations(p, tau);
        for (double& force : multiplier_) force = std::max(force, 0.0);
        gaps(p, tau, w);
        if (report.iterations > limit) return Outcome::iteration_limit;
    }
    spread(lambda);
    for (double& force : lambda)
        if (force <= 4 * noise_) force = 0;
    return Outcome::converged;
}

Index SaddleActiveSet::most_violated(const Problem& p, const Vector& w, bool by_number) const {
    Index worst = -1;
    double least = -4 * noise_;
    for (Index i = 0; i < w.size(); ++i) {
        if (!(w[i] < -p.allowance[i] && w[i] < least)) continue;
        if (w[i] >= -forgivable * p.allowance[i] &&
            std::find(forgiven_.begin(), forgiven_.end(), i) != forgiven_.end())
            continue;
        if (std::find(postponed_.begin(), postponed_.end(), i) != postponed_.end()) continue;
        worst = i;
        if (by_number) break;
        least = w[i];
    }
    return worst;
}

/// Whether the rows without this one no longer hold all modes: 1 over the compliance of its multiplier vanishes.
bool SaddleActiveSet::sets_a_mode_free(Index place) const {
    Vector x = Vector::Zero(factor_.size());
    x[place] = 1;
    factor_.solve_lower(x);
    const Vector y = Y_.transpose() * x;
    const double all = x.squaredNorm();
    return !(all - y.dot(modes_solved(y)) > 1e-12 * all);
}

/// The row whose multiplier falls to zero first, and the step until then. Of those that do so within rounding the one that
/// falls fastest, the soundest pivot, or the first by number.
Index SaddleActiveSet::first_to_leave(const Vector& r, bool by_number, double& step) const {
    const Index k = r.size();
    // Rows are of unit size: below this an entry of r is rounding.
    const double falling = k > 0 ? 1e-11 * std::max(r.lpNorm<Eigen::Infinity>(), 1.0) : 0;
    const double slack = by_number ? 0 : 4 * noise_;
    double within = infinity;
    for (Index i = 0; i < k; ++i)
        if (r[i] > falling) within = std::min(within, (multiplier_[at(i)] + slack) / r[i]);
    Index leaving = -1;
    for (Index i = 0; i < k; ++i) {
        if (!(r[i] > falling) || !(multiplier_[at(i)] / r[i] <= within)) continue;
        if (leaving < 0 || (by_number ? factor_.rows()[at(i)] < factor_.rows()[at(leaving)] : r[i] > r[leaving]))
            leaving = i;
    }
    step = leaving < 0 ? infinity : multiplier_[at(leaving)] / r[leaving];
    return leaving;
}

Outcome SaddleActiveSet::enter(const Problem& p, Index q, bool by_number, const Vector& w, Report& report,
                               double& moved) {
    double multiplier_q = 0, gap_q = w[q];
    while (true) {
        ++report.iterations;
        const Index k = factor_.size();
        Vector l(k);
        const double pivot = factor_.pivot(p.S, q, l);
        const Vector h = p.G.row(q).transpose() - Y_.transpose() * l;
        const Vector shift = modes_solved(h);
        Vector r = l + Y_ * shift;
        factor_.solve_upper(r);
        const double compliance = pivot + h.dot(shift);
        const bool dependent = !(compliance > dependence * p.S(q, q));
        const double full_step = dependent ? infinity : -gap_q / compliance;
        double partial_step = infinity;
        const Index leaving = first_to_leave(r, by_number, partial_step);
        const double step = std::min(full_step, partial_step);
        if (step == infinity) return nothing_moves(p, q, multiplier_q, r, -gap_q);
        for (Index i = 0; i < k; ++i) multiplier_[at(i)] = std::max(multiplier_[at(i)] - step * r[i], 0.0);
        multiplier_q += step;
        if (step > 4 * noise_) moved += step;
        if (full_step <= partial_step) {
            if (!factor_.append(p.S, q)) return Outcome::inaccurate;
            take_modes(p);
            return holds_ ? Outcome::converged : Outcome::inaccurate;
        }
        gap_q += step * compliance;
        const std::vector<Index> rows = factor_.rows();
        bool exchange = sets_a_mode_free(leaving);
        factor_.remove(leaving);
        multiplier_.erase(multiplier_.begin() + leaving);
        take_modes(p);
        exchange |= !holds_;
        if (exchange && !factor_.append(p.S, q)) {
            // An exchange too near to dependence. Where nothing has moved yet another row may enter first.
            if (multiplier_q > 4 * noise_) return Outcome::inaccurate;
            factor_.rebuild(p.S, rows);
            take_modes(p);
            postponed_.push_back(q);
            return holds_ && factor_.size() == k ? Outcome::converged : Outcome::inaccurate;
        }
        if (exchange) take_modes(p);
        if (!holds_) return Outcome::inaccurate;
        if (exchange) return Outcome::converged;
    }
}

/// Row q depends on the active ones, whose multipliers can only grow: infeasible if y = e_q - r says so beyond rounding,
/// else the others hold it, and its multiplier goes to them.
Outcome SaddleActiveSet::nothing_moves(const Problem& p, Index q, double multiplier_q, const Vector& r,
                                       double violation) {
    certificate_ = Vector::Zero(p.g.size());
    certificate_[q] = 1;
    for (Index i = 0; i < r.size(); ++i) certificate_[factor_.rows()[at(i)]] = std::max(-r[i], 0.0);
    const double value = certificate_.dot(p.g), size = certificate_.dot(p.g.cwiseAbs());
    if (value > 1e-9 * size) return Outcome::infeasible;
    if (violation > forgivable * p.allowance[q]) return Outcome::inaccurate;
    forgiven_.push_back(q);
    if (!(multiplier_q > 0)) return Outcome::converged;
    // Along y the forces stay in balance: back to where one of the rows carries nothing.
    double back = multiplier_q;
    Index leaving = -1;
    for (Index i = 0; i < r.size(); ++i)
        if (-r[i] > 0 && multiplier_[at(i)] < back * -r[i]) {
            back = multiplier_[at(i)] / -r[i];
            leaving = i;
        }
    if (leaving < 0) return Outcome::converged;
    factor_.remove(leaving);
    multiplier_.erase(multiplier_.begin() + leaving);
    if (!factor_.append(p.S, q)) return Outcome::inaccurate;
    take_modes(p);
    return holds_ ? Outcome::converged : Outcome::inaccurate;
}

}  // namespace tact
