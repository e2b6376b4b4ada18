#include "smoothed_aggregation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>

#include "../errors.hpp"

namespace tact {
namespace {

constexpr int lanes = SlicedRows<float>::lanes;
using Lanes = SlicedRows<float>::Lanes;

std::size_t at(int i) { return static_cast<std::size_t>(i); }
Lanes load(const float* x) { return SlicedRows<float>::load(x); }
void store(float* x, const Lanes& v) { SlicedRows<float>::store(x, v); }

}  // namespace

SmoothedAggregation::SmoothedAggregation(CompressedRows finest) : A_(std::move(finest)) {
    CompressedRows coarse;
    for (;;) {
        const CompressedRows& A = level_.empty() ? A_ : coarse;
        const auto diagonal = diagonal_of(A);
        if (!std::all_of(diagonal.begin(), diagonal.end(), [](double a) { return a > 0; }))
            throw NumericalError("SmoothedAggregation: level " + std::to_string(level_.size()) +
                                 " has a diagonal entry <= 0: A is not positive definite");
        level_.emplace_back();
        Level& level = level_.back();
        level.size = A.rows;
        level.scale.resize(diagonal.size());
        std::transform(diagonal.begin(), diagonal.end(), level.scale.begin(),
                       [](double a) { return 1 / std::sqrt(a); });
        order_by_colour(level, A);
        store_couplings(level, A);
        if (A.rows <= coarsest_size) break;
        const Aggregates aggregates = aggregates_of(A, diagonal, strength);
        // Where hardly anything is coupled strongly sweeps converge by themselves.
        if (aggregates.root.empty() || 2 * static_cast<int>(aggregates.root.size()) > A.rows) break;
        level.P = smoothed_prolongator(A, diagonal, aggregates);
        level.R = transposed(level.P);
        coarse = galerkin_product(A, level.P, level.R);
        scale_transfer(level, coarse, aggregates);
    }
    for (int l = 0; l + 1 < levels(); ++l) store_transfer(of(l), of(l + 1));
    store_coarsest(levels() == 1 ? A_ : coarse);
    sprung_.resize(level_.size());
    mask(0, {});
}

void SmoothedAggregation::order_by_colour(Level& level, const CompressedRows& A) {
    const auto colour = greedy_colours(A);
    std::vector<int> count;
    for (const int c : colour) {
        if (at(c) >= count.size()) count.resize(at(c) + 1, 0);
        ++count[at(c)];
    }
    level.first_slice.push_back(0);
    for (const int n : count) level.first_slice.push_back(level.first_slice.back() + (n + lanes - 1) / lanes);
    level.padded = level.first_slice.back() * lanes;
    level.unknown.assign(at(level.padded), -1);
    std::vector<int> next;
    for (const int slice : level.first_slice) next.push_back(slice * lanes);
    level.place.resize(at(A.rows));
    for (int i = 0; i < A.rows; ++i) {
        const int place = next[at(colour[at(i)])]++;
        level.unknown[at(place)] = i;
        level.place[at(i)] = place + padding;
    }
    for (Floats* v : {&level.diagonal, &level.inverse, &level.r, &level.x, &level.t})
        v->setZero(level.padded + 2 * padding);
    for (const int place : level.place) level.diagonal[place] = level.inverse[place] = 1;
}

void SmoothedAggregation::store_couplings(Level& level, const CompressedRows& A) {
    const auto fill = [&](int place, const auto& add) {
        const int i = level.unknown[at(place)];
        if (i < 0) return;
        for (int k = A.begin(i); k < A.end(i); ++k) {
            const int j = A.column_at(k);
            if (j != i) add(level.place[at(j)] - padding, A.value_at(k) * level.scale[at(i)] * level.scale[at(j)]);
        }
    };
    level.couplings = SlicedRows<float>(level.padded, A.longest_row(), fill);
    if (&level == &level_.front() && !level.couplings.exact())
        finest_ = SlicedRows<double>(level.padded, A.longest_row(), fill);
}

void SmoothedAggregation::scale_transfer(Level& level, const CompressedRows& coarse, const Aggregates& aggregates) {
    std::vector<double> inverse = diagonal_of(coarse), root(level.scale.size());
    for (double& d : inverse) d = 1 / std::sqrt(d);
    for (std::size_t i = 0; i < root.size(); ++i) root[i] = 1 / level.scale[i];
    for (int i = 0; i < level.P.rows; ++i) {
        double sum = 0;
        for (int k = level.P.begin(i); k < level.P.end(i); ++k) {
            level.P.value[at(k)] *= root[at(i)] * inverse[at(level.P.column_at(k))];
            sum += std::abs(level.P.value_at(k));
        }
        level.row_sum.push_back(static_cast<float>(sum));
    }
    level.aggregate = aggregates.of;
}

void SmoothedAggregation::store_transfer(Level& fine, const Level& coarse) {
    // After a forward sweep the last colour has no residual; before a backward sweep its values do not matter.
    const CompressedRows& P = fine.P;
    const CompressedRows& R = fine.R;
    const int swept = fine.first_slice[fine.first_slice.size() - 2] * lanes;
    fine.prolong = SlicedRows<float>(swept, P.longest_row(), [&](int place, const auto& add) {
        const int i = fine.unknown[at(place)];
        if (i < 0) return;
        for (int k = P.begin(i); k < P.end(i); ++k) add(coarse.place[at(P.column_at(k))] - padding, P.value_at(k));
    });
    fine.restrict_swept = SlicedRows<float>(coarse.padded, R.longest_row(), [&](int place, const auto& add) {
        const int J = coarse.unknown[at(place)];
        if (J < 0) return;
        for (int k = R.begin(J); k < R.end(J); ++k) {
            const int i = R.column_at(k), column = fine.place[at(i)] - padding;
            if (column < swept) add(column, R.value_at(k) * coarse.scale[at(J)] / fine.scale[at(i)]);
        }
    });
    fine.R = {};
}

void SmoothedAggregation::store_coarsest(const CompressedRows& A) {
    const Level& level = level_.back();
    if (level.size > coarsest_size) return;
    coarsest_.setZero(level.size, level.size);
    for (int i = 0; i < A.rows; ++i)
        for (int k = A.begin(i); k < A.end(i); ++k)
            coarsest_(i, A.column_at(k)) =
                static_cast<float>(A.value_at(k) * level.scale[at(i)] * level.scale[at(A.column_at(k))]);
    work_ = coarsest_;
    dense_.setZero(level.size);
}

void SmoothedAggregation::residual(const double* b, const double* x, double* r) const {
    using Doubles = SlicedRows<double>;
    const auto subtract = [&](const auto& rows) {
        for (int s = 0; s < rows.slices(); ++s) {
            Doubles::Lanes sum;
            rows.multiply_slice(s, x + padding, sum);
            const int i = padding + s * lanes;
            Doubles::store(r + i, Doubles::load(b + i) - Doubles::load(x + i) - sum);
        }
    };
    if (level_.front().couplings.exact())
        subtract(level_.front().couplings);
    else
        subtract(finest_);
}

double SmoothedAggregation::residual(int unknown, const double* b, const double* x) const {
    const Level& level = level_.front();
    double sum = 0;
    for (int k = A_.begin(unknown); k < A_.end(unknown); ++k) {
        const auto j = at(A_.column_at(k));
        sum += A_.value_at(k) * level.scale[j] * x[level.place[j]];
    }
    return b[level.place[at(unknown)]] - level.scale[at(unknown)] * sum;
}

void SmoothedAggregation::residual(int level, const float* b, const float* x, float* r) const {
    const auto& rows = of(level).couplings;
    for (int s = 0; s < rows.slices(); ++s) {
        Lanes sum;
        rows.multiply_slice(s, x + padding, sum);
        const int i = padding + s * lanes;
        store(r + i, load(b + i) - load(x + i) - sum);
    }
}

float SmoothedAggregation::multiply(int level, const float* p, float* q, std::span<const int> masked) const {
    const auto& rows = of(level).couplings;
    Lanes dot = {};
    for (int s = 0; s < rows.slices(); ++s) {
        Lanes sum;
        rows.multiply_slice(s, p + padding, sum);
        const int i = padding + s * lanes;
        sum += load(p + i);
        store(q + i, sum);
        dot += load(p + i) * sum;
    }
    for (const int place : masked) q[place] = 0;
    float total = 0;
    for (int l = 0; l < lanes; ++l) total += dot[l];
    return total;
}

void SmoothedAggregation::mask(int level, std::span<const int> masked) {
    for (int l = masked_level_ + 1; l < levels(); ++l) {
        for (const int i : sprung_[at(l)]) {
            of(l).diagonal[of(l).place[at(i)]] = 1;
            of(l).inverse[of(l).place[at(i)]] = 1;
        }
        sprung_[at(l)].clear();
    }
    masked_.assign(masked.begin(), masked.end());
    masked_level_ = level;
    spread_springs();
    factor_coarsest();
}

void SmoothedAggregation::spread_springs() {
    for (int l = masked_level_; l + 1 < levels(); ++l) {
        const Level& fine = of(l);
        Level& coarse = of(l + 1);
        auto& sprung = sprung_[at(l + 1)];
        const auto spread = [&](int i, float spring) {
            for (int k = fine.P.begin(i); k < fine.P.end(i); ++k) {
                const int J = fine.P.column_at(k);
                float& diagonal = coarse.diagonal[coarse.place[at(J)]];
                if (diagonal == 1) sprung.push_back(J);
                diagonal += spring * fine.row_sum[at(i)] * static_cast<float>(std::abs(fine.P.value_at(k)));
            }
        };
        if (l == masked_level_)
            for (const int place : masked_) spread(fine.unknown[at(place - padding)], stiffness);
        else
            for (const int i : sprung_[at(l)]) spread(i, fine.diagonal[fine.place[at(i)]] - 1);
        for (const int J : sprung) {
            const int place = coarse.place[at(J)];
            coarse.inverse[place] = 1 / coarse.diagonal[place];
        }
    }
}

void SmoothedAggregation::factor_coarsest() {
    const Level& level = level_.back();
    if (level.size > coarsest_size) return;
    work_ = coarsest_;
    for (int i = 0; i < level.size; ++i) work_(i, i) = level.diagonal[level.place[at(i)]];
    if (masked_level_ + 1 == levels())
        for (const int place : masked_) {
            const int i = level.unknown[at(place - padding)];
            work_.row(i).setZero();
            work_.col(i).setZero();
            work_(i, i) = 1;
        }
    // Positive definite in double may be indefinite in single precision: a preconditioner may be shifted.
    for (float shift = 1e-6F; factor_.compute(work_).info() != Eigen::Success && shift < 1; shift *= 10)
        work_.diagonal().array() += shift;
}

void SmoothedAggregation::sweep(int number, int colour, const float* r, float* x) const {
    const Level& level = of(number);
    const int begin = level.first_slice[at(colour)], end = level.first_slice[at(colour) + 1];
    const bool springs = number > masked_level_ && !sprung_[at(number)].empty();
    for (int s = begin; s < end; ++s) {
        Lanes sum;
        level.couplings.multiply_slice(s, x + padding, sum);
        const int i = padding + s * lanes;
        Lanes next = load(r + i) - sum;
        if (springs) next *= load(&level.inverse[i]);
        store(x + i, next);
    }
    if (number == masked_level_) hold(x);
}

void SmoothedAggregation::hold(float* x) const {
    for (const int place : masked_) x[place] = 0;
}

void SmoothedAggregation::descend(int number, const float* r, float* x) {
    Level& level = of(number);
    const bool masked = number == masked_level_;
    if (number + 1 == levels() && level.size <= coarsest_size) {
        for (int i = 0; i < level.size; ++i) dense_[i] = r[level.place[at(i)]];
        factor_.solveInPlace(dense_);
        for (int i = 0; i < level.size; ++i) x[level.place[at(i)]] = dense_[i];
        if (masked) hold(x);
        return;
    }
    sweep_from_zero(number, r, x);
    correct(number, r, x);
    const int colours = static_cast<int>(level.first_slice.size()) - 1;
    for (int colour = colours - 1; colour >= 0; --colour) sweep(number, colour, r, x);
    // Coarse levels cost little: a second visit keeps the number of cycles nearly independent of the size.
    if (number < first_visited_twice || number + 1 == levels()) return;
    for (int colour = 0; colour < colours; ++colour) sweep(number, colour, r, x);
    correct(number, r, x);
    for (int colour = colours - 1; colour >= 0; --colour) sweep(number, colour, r, x);
}

void SmoothedAggregation::sweep_from_zero(int number, const float* r, float* x) const {
    // The first colour is coupled to nothing yet.
    const Level& level = of(number);
    const int colours = static_cast<int>(level.first_slice.size()) - 1;
    const int first = lanes * level.first_slice[1];
    for (int i = padding; i < padding + first; i += lanes) store(x + i, load(&level.inverse[i]) * load(r + i));
    if (number == masked_level_) hold(x);
    if (colours > 2) std::fill(x + padding + first, x + padding + level.padded, 0.0F);
    for (int colour = 1; colour < colours; ++colour) sweep(number, colour, r, x);
}

void SmoothedAggregation::correct(int number, const float* r, float* x) {
    if (number + 1 == levels()) return;
    Level& level = of(number);
    Level& coarse = of(number + 1);
    const bool masked = number == masked_level_;
    const int last = lanes * level.first_slice[level.first_slice.size() - 2];
    float* t = level.t.data();
    for (int i = padding, s = 0; i < padding + last; i += lanes, ++s) {
        Lanes sum;
        level.couplings.multiply_slice(s, x + padding, sum);
        store(t + i, load(r + i) - load(&level.diagonal[i]) * load(x + i) - sum);
    }
    if (masked) hold(t);
    for (int s = 0; s < level.restrict_swept.slices(); ++s) {
        Lanes sum;
        level.restrict_swept.multiply_slice(s, t + padding, sum);
        store(&coarse.r[padding + s * lanes], sum);
    }
    descend(number + 1, coarse.r.data(), coarse.x.data());
    for (int i = padding, s = 0; i < padding + last; i += lanes, ++s) {
        Lanes sum;
        level.prolong.multiply_slice(s, coarse.x.data() + padding, sum);
        store(x + i, load(x + i) + sum);
    }
    if (masked) hold(x);
}

void SmoothedAggregation::restrict_all(int number, const float* r, float* coarse) const {
    const Level& fine = of(number);
    const Level& next = of(number + 1);
    std::fill(coarse, coarse + next.padded + 2 * padding, 0.0F);
    for (int i = 0; i < fine.size; ++i)
        for (int k = fine.P.begin(i); k < fine.P.end(i); ++k)
            coarse[next.place[at(fine.P.column_at(k))]] +=
                static_cast<float>(fine.P.value_at(k)) * r[fine.place[at(i)]];
}

void SmoothedAggregation::restrict_bounds(int number, const float* lower, const float* upper, float* coarse_lower,
                                          float* coarse_upper) const {
    const Level& fine = of(number);
    const Level& next = of(number + 1);
    for (const int place : next.place) {
        coarse_lower[place] = -std::numeric_limits<float>::infinity();
        coarse_upper[place] = std::numeric_limits<float>::infinity();
    }
    for (int i = 0; i < fine.size; ++i) {
        if (fine.aggregate[at(i)] < 0) continue;
        const int from = fine.place[at(i)], to = next.place[at(fine.aggregate[at(i)])];
        coarse_lower[to] = std::max(coarse_lower[to], lower[from] / fine.row_sum[at(i)]);
        coarse_upper[to] = std::min(coarse_upper[to], upper[from] / fine.row_sum[at(i)]);
    }
    // Bounds of different unknowns of one aggregate may exclude each other.
    for (const int place : next.place) coarse_upper[place] = std::max(coarse_upper[place], coarse_lower[place]);
}

void SmoothedAggregation::prolong_all(int number, const float* coarse, const float* r, float* x) const {
    const Level& fine = of(number);
    for (int s = 0; s < fine.prolong.slices(); ++s) {
        Lanes sum;
        fine.prolong.multiply_slice(s, coarse + padding, sum);
        store(x + padding + s * lanes, sum);
    }
    std::fill(x + padding + fine.prolong.slices() * lanes, x + padding + fine.padded, 0.0F);
    sweep(number, static_cast<int>(fine.first_slice.size()) - 2, r, x);
}

}  // namespace tact
