#include "few_rows.hpp"

#include <algorithm>
#include <cmath>

namespace tact {
namespace {

/// a'x, b'x, c'x and d'x, which read x once and do not wait for one another.
Eigen::Array4d products(const double* a, const double* b, const double* c, const double* d, const Vector& x) {
    constexpr Index lanes = 8;
    using Lanes = Eigen::Array<double, lanes, 1>;
    using Map = Eigen::Map<const Lanes>;
    Lanes sum_a = Lanes::Zero(), sum_b = sum_a, sum_c = sum_a, sum_d = sum_a;
    Index i = 0;
    for (; i + lanes <= x.size(); i += lanes) {
        const Lanes part = Map(x.data() + i);
        sum_a += Map(a + i) * part;
        sum_b += Map(b + i) * part;
        sum_c += Map(c + i) * part;
        sum_d += Map(d + i) * part;
    }
    Eigen::Array4d sum(sum_a.sum(), sum_b.sum(), sum_c.sum(), sum_d.sum());
    for (; i < x.size(); ++i) sum += x[i] * Eigen::Array4d(a[i], b[i], c[i], d[i]);
    return sum;
}

}  // namespace

FewRows::FewRows(const Matrix& A, const DenseMatrix& B, const CondensedRows& condensed)
    : condensed_(condensed),
      rows_(condensed.B.transpose()),
      screen_(B),
      certificate_(A, Matrix(B)),
      play_(condensed),
      bound_of_(static_cast<std::size_t>(B.rows()), -1),
      free_(B.cols()),
      lambda_(Vector::Zero(B.rows())),
      soft_c_(B.rows()) {
    for (std::size_t k = 0; k < condensed.bounds.size(); ++k)
        bound_of_[static_cast<std::size_t>(condensed.bounds[k].row)] = static_cast<Index>(k);
    listed_.reserve(bound_of_.size());
    pressed_.reserve(bound_of_.size());
}

/// The row joins C with the violation that A^-1 b leaves it.
void FewRows::enter(Index row, const ConstVectorRef& c) {
    const Index place = play_.size();
    play_.add(row);
    measure(place, c);
}

void FewRows::measure(Index place, const ConstVectorRef& c) {
    measure(place, c, rows_.col(play_.rows()[static_cast<std::size_t>(place)]).dot(free_));
}

void FewRows::measure(Index place, const ConstVectorRef& c, double moved) {
    const Index row = play_.rows()[static_cast<std::size_t>(place)];
    const double bound = c[row] * condensed_.scale[row];
    play_.violation(place) = bound - moved;
    play_.allowance(place) = CondensedRows::gap_tolerance * (std::abs(bound) + std::abs(moved));
    gap_size_ = std::max(gap_size_, std::max(std::abs(bound), std::abs(moved)) / condensed_.scale[row]);
}

void FewRows::measure_all(const ConstVectorRef& c) {
    const auto row = [&](Index place) { return rows_.col(play_.rows()[static_cast<std::size_t>(place)]).data(); };
    Index place = 0;
    for (; place + 4 <= play_.size(); place += 4) {
        const Eigen::Array4d moved = products(row(place), row(place + 1), row(place + 2), row(place + 3), free_);
        for (Index k = 0; k < 4; ++k) measure(place + k, c, moved[k]);
    }
    for (; place < play_.size(); ++place) measure(place, c);
}

/// C for a guess: what was in play last time, unless that is many more.
void FewRows::start(const ConstVectorRef& c, const ConstVectorRef& guess) {
    constexpr Index spare = 8;
    listed_.clear();
    for (Index i = 0; i < guess.size(); ++i)
        if (guess[i] > 0 && c[i] > -infinity) listed_.push_back(i);
    if (play_.size() > static_cast<Index>(listed_.size()) + spare) play_.clear();
    measure_all(c);
    for (const Index row : listed_)
        if (!play_.holds(row)) enter(row, c);
    for (Index k = 0; k < play_.size(); ++k) {
        const Index row = play_.rows()[static_cast<std::size_t>(k)];
        play_.multiplier(k) = std::max(guess[row], 0.0) / condensed_.scale[row];
    }
}

/// u = A^-1 (b + B'lambda) for the multipliers of C.
void FewRows::move(const ConstVectorRef& c, Vector& u) {
    pressed_.clear();
    for (Index k = 0; k < play_.size(); ++k)
        if (play_.multiplier(k) > 0) pressed_.push_back(k);
    u = free_;
    const auto part = [&](std::size_t k) {
        return play_.multiplier(pressed_[k]) * condensed_.W.col(play_.rows()[static_cast<std::size_t>(pressed_[k])]);
    };
    std::size_t k = 0;
    for (; k + 4 <= pressed_.size(); k += 4) u += part(k) + part(k + 1) + part(k + 2) + part(k + 3);
    for (; k < pressed_.size(); ++k) u += part(k);
    if (condensed_.bounds.empty()) return;
    // A bound is met exactly: a gap of zero then is zero, not rounding.
    for (const Index place : pressed_) {
        const Index row = play_.rows()[static_cast<std::size_t>(place)];
        const Index bound = bound_of_[static_cast<std::size_t>(row)];
        if (bound < 0) continue;
        const auto& [same_row, column, weight] = condensed_.bounds[static_cast<std::size_t>(bound)];
        u[column] = c[same_row] / weight;
    }
}

/// Lists the rows in doubt at u and lets them join C, of very many only the worst; whether one of them is violated.
bool FewRows::take_in_doubt(const ConstVectorRef& c, const Vector& u, std::size_t most) {
    bool violated = false;
    listed_.clear();
    fresh_.clear();
    for (const Index row : screen_.in_doubt(u, c)) {
        listed_.push_back(row);
        if (!play_.holds(row)) fresh_.push_back(row);
    }
    if (fresh_.empty()) return false;
    if (play_.size() == 0) free_ = u;
    if (fresh_.size() > most) {
        depth_.clear();
        for (const Index row : fresh_)
            depth_.emplace_back(rows_.col(row).dot(u) - c[row] * condensed_.scale[row], row);
        std::nth_element(depth_.begin(), depth_.begin() + static_cast<std::ptrdiff_t>(most), depth_.end());
        fresh_.clear();
        for (std::size_t k = 0; k < most; ++k) fresh_.push_back(depth_[k].second);
    }
    for (const Index row : fresh_) {
        const Index place = play_.size();
        enter(row, c);
        const double gap = rows_.col(row).dot(u) - c[row] * condensed_.scale[row];
        violated |= gap < -play_.allowance(place);
    }
    return violated;
}

bool FewRows::solve(ContactReport& report, const ConstVectorRef& b, const ConstVectorRef& c, Vector& u,
                    ContactPoint point, double tolerance) {
    gap_size_ = 0;
    bool violated = point.lambda.maxCoeff() > 0;
    if (violated) {
        free_ = u;
        start(c, point.lambda);
    } else if (play_.size() > 0) {
        play_.clear();
    }
    // Without S a row in play costs its entries, and of very many that are violated at first few will be held.
    std::size_t most = condensed_.S.size() > 0 ? bound_of_.size() : few;
    do {
        if (violated) {
            const GoldfarbIdnani::Report dual = play_.solve();
            report.iterations += dual.iterations;
            if (dual.outcome != Outcome::converged || play_.forgave()) return false;
            move(c, u);
        }
        violated = take_in_doubt(c, u, most);
        most *= 2;
    } while (violated);
    for (Index k = 0; k < play_.size(); ++k) {
        if (!(play_.multiplier(k) > 0)) continue;
        const Index row = play_.rows()[static_cast<std::size_t>(k)];
        ++report.active;
        lambda_[row] = play_.multiplier(k) * condensed_.scale[row];
        if (std::find(listed_.begin(), listed_.end(), row) == listed_.end()) listed_.push_back(row);
    }
    const bool soft = condensed_.compliance.size() > 0;
    if (soft)
        for (const Index row : listed_) soft_c_[row] = c[row] - condensed_.compliance[row] * lambda_[row];
    report.kkt = certificate_(b, soft ? ConstVectorRef(soft_c_) : c, u, lambda_, listed_);
    const bool taken = report.kkt.within(tolerance, gap_size_);
    if (taken) {
        point.u = u;
        point.lambda = lambda_;
    }
    for (const Index row : play_.rows()) lambda_[row] = 0;
    return taken;
}

}  // namespace tact
