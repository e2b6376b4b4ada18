#include "multigrid_active_set.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <string>
#include <vector>

#include "../../lib/algebra/empty_rows.hpp"
#include "../../lib/sparse/smoothed_aggregation.hpp"
#include "multigrid_krylov.hpp"

namespace tact {
namespace {

using Floats = SmoothedAggregation::Floats;

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

/// Rows of B with one entry each.
struct Bounds {
    std::vector<int> unknown;
    std::vector<double> weight;

    static Bounds of(const Matrix& B) {
        Bounds bounds{std::vector<int>(at(B.rows()), -1), std::vector<double>(at(B.rows()), 0.0)};
        const auto refuse = [&] {
            throw InputError("MultigridActiveSet: B is " + B.shape() +
                             " with a row of no or several entries, expected one a row");
        };
        if (const Vector* diagonal = B.diagonal_entries(); diagonal && (diagonal->array() != 0).all()) {
            std::iota(bounds.unknown.begin(), bounds.unknown.end(), 0);
            bounds.weight.assign(diagonal->begin(), diagonal->end());
            return bounds;
        }
        const SparseMatrix copy = B.sparse() ? SparseMatrix() : B.to_sparse();
        const SparseMatrix& S = B.sparse() ? *B.sparse() : copy;
        for (Index j = 0; j < S.outerSize(); ++j)
            for (SparseMatrix::InnerIterator it(S, j); it; ++it) {
                if (it.value() == 0) continue;
                if (bounds.unknown[at(it.row())] >= 0) refuse();
                bounds.unknown[at(it.row())] = static_cast<int>(j);
                bounds.weight[at(it.row())] = it.value();
            }
        if (std::find(bounds.unknown.begin(), bounds.unknown.end(), -1) != bounds.unknown.end()) refuse();
        return bounds;
    }
};

/// The obstacle problem of a coarse level, for a correction of the finest.
struct CoarseObstacle {
    Floats lower, upper, b, x;
    Krylov krylov;
};

class PreparedMultigrid final : public PreparedContact {
public:
    PreparedMultigrid(const Matrix& A, const Matrix& B, CompressedRows rows, Bounds bounds)
        : certificate_(A, B), bounds_(std::move(bounds)), hierarchy_(std::move(rows)) {
        place_ = hierarchy_.place(0);
        scale_ = Eigen::Map<const Vector>(hierarchy_.scale(0).data(), A.rows());
        const Index padded = hierarchy_.padded(0);
        for (Vector* v : {&x_, &b_, &r_}) v->setZero(padded);
        krylov_.resize(padded);
        lower_.setConstant(padded, -infinity);
        upper_.setConstant(padded, infinity);
        u_.resize(A.rows());
        lambda_.resize(B.rows());
        side_.assign(at(padded), 0);
        seen_.assign(at(A.rows()), 0);
        coarse_.resize(at(hierarchy_.levels()));
        for (int l = 1; l < hierarchy_.levels(); ++l) {
            CoarseObstacle& c = coarse_[at(l)];
            for (Floats* v : {&c.lower, &c.upper, &c.b, &c.x}) v->setZero(hierarchy_.padded(l));
            c.krylov.resize(hierarchy_.padded(l));
        }
        upper_used_ = std::any_of(bounds_.weight.begin(), bounds_.weight.end(), [](double w) { return w < 0; });
    }

    bool reads_guess() const override { return true; }

    ContactReport solve(const ConstVectorRef& b, const ConstVectorRef& c, ContactPoint point) override {
        ContactReport report;
        report.strategy = "multigrid active set";
        report.outcome = load(b, c, point.u);
        if (report.outcome != Outcome::converged) return report;
        if (!guess_is_near()) start_from_coarse_levels();
        settled_.clear();
        krylov_.rz = 0;
        double left = infinity, unit = 1;  // of the residual: what the last round left, what it was measured in
        for (report.iterations = 1;; ++report.iterations) {
            bool changed = join();
            hierarchy_.residual(b_.data(), x_.data(), r_.data());
            const double floor = accuracy * size();
            changed |= leave(floor);
            if (changed) relax();
            const double largest = mask_residual();
            if (!std::isfinite(largest)) report.outcome = Outcome::inaccurate;
            if (report.iterations == iteration_limit) report.outcome = Outcome::iteration_limit;
            if (changed && left <= floor && came_back()) {
                report.set_repeated = true;
                report.outcome = Outcome::cycling;
            }
            if (report.outcome != Outcome::converged) return report;
            if (!changed && largest <= floor) break;
            if (changed) {
                hierarchy_.mask(0, active_);
                krylov_.rz = 0;
            }
            const double share =
                changed ? inexactness : std::clamp(0.5 * floor / largest, float_accuracy, inexactness);
            left = largest * krylov_.solve(hierarchy_, 0, active_, share, unit / largest);
            x_ += largest * krylov_.correction.cast<double>();
            unit = largest;
        }
        return finish(b, c, point, report);
    }

private:
    static constexpr double accuracy = 2e-13;
    static constexpr double acceptable = 1e-12;
    static constexpr double inexactness = 0.1;
    /// Of one correction in single precision, whose rounding is amplified by the condition number.
    static constexpr double float_accuracy = 1e-3;
    static constexpr int iteration_limit = 200;
    static constexpr double near = 0.01;
    static constexpr int rings = 4, sweeps = 8;
    static constexpr int coarse_rounds = 3;
    static constexpr double coarse_share = 0.1;

    double size() const { return std::max({x_.lpNorm<Eigen::Infinity>(), b_size_, underflow}); }

    Outcome load(const ConstVectorRef& b, const ConstVectorRef& c, const ConstVectorRef& guess) {
        for (std::size_t i = 0; i < place_.size(); ++i) {
            const auto k = static_cast<Index>(i);
            b_[place_[i]] = b[k] * scale_[k];
            x_[place_[i]] = guess[k] / scale_[k];
        }
        for (const int place : bounds_.unknown) {
            lower_[place_[at(place)]] = -infinity;
            upper_[place_[at(place)]] = infinity;
        }
        bool finite = true, feasible = true;
        for (std::size_t i = 0; i < bounds_.unknown.size(); ++i) {
            const auto unknown = at(bounds_.unknown[i]);
            const int place = place_[unknown];
            const double bound = bound_of(i, c) / scale_[bounds_.unknown[i]];
            finite &= !std::isnan(bound) && c[static_cast<Index>(i)] != infinity;
            if (bounds_.weight[i] > 0)
                lower_[place] = std::max(lower_[place], bound);
            else
                upper_[place] = std::min(upper_[place], bound);
            feasible &= lower_[place] <= upper_[place];
        }
        for (const int place : active_) side_[at(place)] = 0;
        active_.clear();
        hierarchy_.mask(0, active_);
        b_size_ = b_.lpNorm<Eigen::Infinity>();
        if (!finite || !b_.allFinite() || !x_.allFinite()) return Outcome::inaccurate;
        return feasible ? Outcome::converged : Outcome::infeasible;
    }

    double bound_of(std::size_t row, const ConstVectorRef& c) const {
        return c[static_cast<Index>(row)] / bounds_.weight[row];
    }

    /// Whether the guess, moved to its bounds, is nearly at rest: the free residual is small against what the bounds
    /// hold. Such a guess knows more than the coarse levels; it is taken with its set.
    bool guess_is_near() {
        guess_ = x_;
        x_ = x_.cwiseMax(lower_).cwiseMin(upper_);
        hierarchy_.residual(b_.data(), x_.data(), r_.data());
        double held = 0, free = 0;
        for (const int i : place_) {
            const bool below = x_[i] == lower_[i] && r_[i] < 0, above = x_[i] == upper_[i] && r_[i] > 0;
            double& largest = below || above ? held : free;
            largest = std::max(largest, std::abs(r_[i]));
            if (!below && !above) continue;
            side_[at(i)] = below ? -1 : 1;
            active_.push_back(i);
        }
        if (free <= near * held) {
            hierarchy_.mask(0, active_);
            return true;
        }
        for (const int i : active_) side_[at(i)] = 0;
        active_.clear();
        x_.swap(guess_);
        return false;
    }

    /// The best correction of x_ that the coarse levels can see, coarsest first.
    void start_from_coarse_levels() {
        if (hierarchy_.levels() == 1) return;
        hierarchy_.residual(b_.data(), x_.data(), r_.data());
        krylov_.residual = r_.cast<float>();
        lower_gap_ = (lower_ - x_).cast<float>();
        upper_gap_ = (upper_ - x_).cast<float>();
        for (int l = 1; l < hierarchy_.levels(); ++l) {
            CoarseObstacle& c = coarse_[at(l)];
            CoarseObstacle& f = coarse_[at(l - 1)];
            hierarchy_.restrict_all(l - 1, l == 1 ? krylov_.residual.data() : f.b.data(), c.b.data());
            hierarchy_.restrict_bounds(l - 1, l == 1 ? lower_gap_.data() : f.lower.data(),
                                       l == 1 ? upper_gap_.data() : f.upper.data(), c.lower.data(), c.upper.data());
        }
        for (int l = hierarchy_.levels() - 1; l > 0; --l) {
            CoarseObstacle& c = coarse_[at(l)];
            if (l + 1 == hierarchy_.levels())
                c.x.setZero();
            else
                hierarchy_.prolong_all(l, coarse_[at(l + 1)].x.data(), c.b.data(), c.x.data());
            solve_coarse(l, c);
        }
        hierarchy_.prolong_all(0, coarse_[1].x.data(), krylov_.residual.data(), krylov_.z.data());
        x_ += krylov_.z.cast<double>();
        hierarchy_.mask(0, active_);
    }

    /// A few rounds of the fine level's kind, all in single precision.
    void solve_coarse(int level, CoarseObstacle& c) {
        Floats& r = c.krylov.residual;
        for (int k = 0; k < coarse_rounds; ++k) {
            c.x = c.x.cwiseMax(c.lower).cwiseMin(c.upper);
            hierarchy_.residual(level, c.b.data(), c.x.data(), r.data());
            masked_.clear();
            for (const int i : hierarchy_.place(level))
                if (c.x[i] + r[i] < c.lower[i] || c.x[i] + r[i] > c.upper[i]) {
                    c.x[i] = c.x[i] + r[i] < c.lower[i] ? c.lower[i] : c.upper[i];
                    masked_.push_back(i);
                }
            hierarchy_.residual(level, c.b.data(), c.x.data(), r.data());
            for (const int i : masked_) r[i] = 0;
            hierarchy_.mask(level, masked_);
            c.krylov.rz = 0;
            (void)c.krylov.solve(hierarchy_, level, masked_, coarse_share, 1);
            c.x += c.krylov.correction;
        }
    }

    /// Unknowns beyond a bound are put on it and held there.
    bool join() {
        constexpr Index block = 256;
        changed_.clear();
        for (Index first = 0; first < x_.size(); first += block) {
            const Index count = std::min(block, x_.size() - first);
            const auto x = x_.segment(first, count).array();
            // The largest excess instead of any(): Eigen has vector code for it.
            const bool beyond = (lower_.segment(first, count).array() - x).maxCoeff() > 0 ||
                                (upper_used_ && (x - upper_.segment(first, count).array()).maxCoeff() > 0);
            for (Index i = first; beyond && i < first + count; ++i) {
                const int side = x_[i] < lower_[i] ? -1 : x_[i] > upper_[i] ? 1 : 0;
                if (side == 0) continue;
                x_[i] = side < 0 ? lower_[i] : upper_[i];
                side_[at(i)] = static_cast<signed char>(side);
                active_.push_back(static_cast<int>(i));
                changed_.push_back(static_cast<int>(i));
            }
        }
        return !changed_.empty();
    }

    /// Unknowns whose bound pulls instead of pushing are free again; below the floor a sign says nothing.
    bool leave(double floor) {
        const auto last = std::remove_if(active_.begin(), active_.end(), [&](int i) {
            // The force that holds i is -r; a lower bound pushes up.
            const bool pulls = side_[at(i)] * r_[i] < -floor;
            if (pulls) {
                side_[at(i)] = 0;
                changed_.push_back(i);
            }
            return pulls;
        });
        const bool changed = last != active_.end();
        active_.erase(last, active_.end());
        return changed;
    }

    /// Projected Gauss-Seidel around the unknowns that joined or left: what is local about the set is settled for the
    /// price of a part of a cycle, several layers at once, where the active set alone peels off one a round.
    void relax() {
        near_.clear();
        const auto reach = [&](int unknown) {
            if (seen_[at(unknown)]) return;
            seen_[at(unknown)] = 1;
            near_.push_back(unknown);
        };
        for (const int i : changed_) reach(hierarchy_.unknown(i));
        const CompressedRows& A = hierarchy_.finest();
        std::size_t inner = 0;
        for (int ring = 0; ring <= rings; ++ring) {
            const auto first = inner;
            inner = near_.size();
            for (auto k = first; k < inner; ++k)
                for (int e = A.begin(near_[k]); e < A.end(near_[k]); ++e) reach(A.column_at(e));
        }
        const auto& place = hierarchy_.place(0);
        const auto update = [&](int unknown) {
            const int i = place[at(unknown)];
            x_[i] =
                std::min(std::max(x_[i] + hierarchy_.residual(unknown, b_.data(), x_.data()), lower_[i]), upper_[i]);
        };
        for (int sweep = 0; sweep < sweeps; ++sweep) {
            for (std::size_t k = 0; k < inner; ++k) update(near_[k]);
            for (std::size_t k = inner; k-- > 0;) update(near_[k]);
        }
        for (const int unknown : near_) {
            const int i = place[at(unknown)];
            seen_[at(unknown)] = 0;
            r_[i] = hierarchy_.residual(unknown, b_.data(), x_.data());
        }
        for (std::size_t k = 0; k < inner; ++k) {
            const int i = place[at(near_[k])];
            const signed char before = side_[at(i)];
            side_[at(i)] = x_[i] == lower_[i] && r_[i] < 0 ? -1 : x_[i] == upper_[i] && r_[i] > 0 ? 1 : 0;
            if (before == 0 && side_[at(i)] != 0) active_.push_back(i);
        }
        std::erase_if(active_, [&](int i) { return side_[at(i)] == 0; });
    }

    /// residual_ := r_ on the free unknowns over its largest entry, which is returned.
    double mask_residual() {
        force_.resize(active_.size());
        for (std::size_t k = 0; k < active_.size(); ++k) {
            force_[k] = -r_[active_[k]];
            r_[active_[k]] = 0;
        }
        const double largest = r_.lpNorm<Eigen::Infinity>();
        if (largest > 0) krylov_.residual = (r_ * (1 / largest)).cast<float>();
        return largest;
    }

    bool came_back() {
        std::uint64_t hash = 0;
        for (const int i : active_) {
            // A sum over the set, whatever its order, of well mixed words.
            auto word = static_cast<std::uint64_t>(2 * i + (side_[at(i)] > 0)) * 0x9e3779b97f4a7c15ULL;
            word = (word ^ (word >> 29)) * 0xbf58476d1ce4e5b9ULL;
            hash += word ^ (word >> 32);
        }
        const bool known = std::find(settled_.begin(), settled_.end(), hash) != settled_.end();
        settled_.push_back(hash);
        return known;
    }

    ContactReport finish(const ConstVectorRef& b, const ConstVectorRef& c, ContactPoint point, ContactReport report) {
        for (Index i = 0; i < u_.size(); ++i) u_[i] = x_[place_[at(i)]] * scale_[i];
        for (std::size_t k = 0; k < active_.size(); ++k) r_[active_[k]] = force_[k];
        lambda_.setZero();
        for (std::size_t i = 0; i < bounds_.unknown.size(); ++i) {
            const Index unknown = bounds_.unknown[i];
            const int place = place_[at(unknown)];
            const double bound = bound_of(i, c), weight = bounds_.weight[i];
            if (side_[at(place)] != 0 && weight * side_[at(place)] < 0 &&
                bound / scale_[unknown] == (weight > 0 ? lower_[place] : upper_[place])) {
                u_[unknown] = bound;
                const double force = r_[place] / (scale_[unknown] * weight);
                r_[place] = 0;  // the next row on this unknown carries nothing
                if (force > 0) {
                    lambda_[static_cast<Index>(i)] = force;
                    ++report.active;
                }
            }
        }
        report.kkt = certificate_(b, c, u_, lambda_);
        if (!report.kkt.within(acceptable,
                               std::max(point.u.lpNorm<Eigen::Infinity>(), u_.lpNorm<Eigen::Infinity>()))) {
            report.outcome = Outcome::inaccurate;
            return report;
        }
        point.u = u_;
        point.lambda = lambda_;
        return report;
    }

    KktCertificate certificate_;
    Bounds bounds_;
    SmoothedAggregation hierarchy_;
    std::vector<int> place_;  // of each unknown, in the vectors of the finest level
    Vector scale_;
    bool upper_used_ = false;
    double b_size_ = 0;
    std::vector<int> active_, masked_, changed_, near_;
    std::vector<char> seen_;
    std::vector<signed char> side_;  // of the active: -1 on the lower bound, 1 on the upper
    std::vector<std::uint64_t> settled_;
    std::vector<CoarseObstacle> coarse_;
    Vector x_, guess_, b_, r_, lower_, upper_, u_, lambda_;
    std::vector<double> force_;  // that holds each active unknown
    Krylov krylov_;
    Floats lower_gap_, upper_gap_;
};

}  // namespace

std::unique_ptr<PreparedContact> MultigridActiveSet::prepare(const Matrix& A, const Matrix& B) const {
    const auto refuse = [&] {
        throw InputError("MultigridActiveSet: A is " + A.shape() + " and B is " + B.shape() +
                         ", expected a square symmetric A and as many columns in B");
    };
    check_contact_matrices("MultigridActiveSet", A, B);
    if (has_empty_rows(B)) return prepare_without_empty_rows(*this, A, B);
    const SparseMatrix copy = A.sparse() ? SparseMatrix() : A.to_sparse();
    CompressedRows rows = compressed_columns(A.sparse() ? *A.sparse() : copy);
    if (!A.is_symmetric()) refuse();
    const auto diagonal = diagonal_of(rows);
    if (!std::all_of(diagonal.begin(), diagonal.end(), [](double a) { return a > 0; }))
        throw InputError("MultigridActiveSet: A has a diagonal entry <= 0, expected positive definite");
    return std::make_unique<PreparedMultigrid>(A, B, std::move(rows), Bounds::of(B));
}

}  // namespace tact
