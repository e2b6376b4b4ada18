#include "tact/contact/colour_sor.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <vector>

#include "tact/contact/rows.hpp"
#include "tact/lib/sparse/lanczos.hpp"
#include "tact/lib/sparse/sliced_ell.hpp"

namespace tact {
namespace {

constexpr Index lanes = SlicedEll::lanes;
constexpr Index padding = SlicedEll::padding;

class PreparedSor final : public PreparedContact {
public:
    PreparedSor(const Matrix& A, const Matrix& B) : certificate_(A, B), n_(A.rows()) {
        const SparseMatrix sparse = A.to_sparse();
        scale_ = A.main_diagonal().cwiseSqrt().cwiseInverse();
        order_by_colour(sparse);
        const SparseMatrix scaled = scale_.asDiagonal() * sparse * scale_.asDiagonal();
        for (std::size_t k = 0; k + 1 < first_.size(); ++k) {
            const std::vector<Index> rows(order_.begin() + first_[k], order_.begin() + first_[k + 1]);
            sweep_.emplace_back(scaled, rows, position_, true);
        }
        const ConstraintRows rows(B);
        shared_ = !rows.disjoint();
        for (Index i = 0; i < rows.rows(); ++i) {
            unknown_scale_.push_back(1 / scale_[rows.columns(i)[0]]);
            unknown_.push_back(position_[static_cast<std::size_t>(rows.columns(i)[0])]);
            weight_.push_back(rows.weights(i)[0]);
            lower_only_ &= rows.weights(i)[0] > 0;
        }
        for (Vector* v : {&x_, &b_, &lower_, &upper_}) v->setZero(padded_size());
        u_.resize(n_);
        lambda_.resize(B.rows());
        // Young's formula, exact for two colours; with more it is a good guess that converges all the same.
        const double radius = std::min(std::max(1 - scaled_spectrum(A).smallest, 0.0), 0.999999);
        omega_ = 2 / (1 + std::sqrt(1 - radius * radius));
    }

    bool reads_guess() const override { return true; }

    ContactReport solve(const ConstVectorRef& b, const ConstVectorRef& c, ContactPoint point) override {
        ContactReport report;
        report.strategy = "colour SOR";
        for (Index i = 0; i < n_; ++i) {
            const Index old = order_[static_cast<std::size_t>(i)];
            x_[place(i)] = point.u[old] * inverse_scale_[i];
            b_[place(i)] = b[old] * colour_scale_[i];
        }
        set_bounds(c);
        const double scale = std::max(x_.lpNorm<Eigen::Infinity>(), b_.lpNorm<Eigen::Infinity>());
        const double goal = accuracy * scale;
        for (report.iterations = 1;; ++report.iterations) {
            const double change = sweep();
            if (change <= goal) break;
            if (report.iterations == sweep_limit || !std::isfinite(change)) {
                report.outcome = std::isfinite(change) ? Outcome::iteration_limit : Outcome::inaccurate;
                return report;
            }
        }
        for (Index i = 0; i < n_; ++i) u_[order_[static_cast<std::size_t>(i)]] = x_[place(i)] * colour_scale_[i];
        multipliers(c);
        const double size = std::max(point.u.lpNorm<Eigen::Infinity>(), u_.lpNorm<Eigen::Infinity>());
        certify(report, certificate_, b, c, u_, lambda_, acceptable, size, point);
        return report;
    }

private:
    static constexpr double accuracy = 5e-13;
    static constexpr double acceptable = 1e-10;
    static constexpr int sweep_limit = 2000;

    /// Each colour starts on a whole slice: unknown number i of the colour order lies at place(i).
    Index place(Index i) const { return place_[static_cast<std::size_t>(i)]; }
    Index padded_size() const { return padded_ + 2 * padding; }

    void order_by_colour(const SparseMatrix& A) {
        const auto colour = greedy_colouring(A);
        const int colours = 1 + *std::max_element(colour.begin(), colour.end());
        order_.resize(static_cast<std::size_t>(n_));
        std::iota(order_.begin(), order_.end(), Index{0});
        std::stable_sort(order_.begin(), order_.end(), [&](Index i, Index j) {
            return colour[static_cast<std::size_t>(i)] < colour[static_cast<std::size_t>(j)];
        });
        first_.assign(static_cast<std::size_t>(colours) + 1, 0);
        for (const int k : colour) ++first_[static_cast<std::size_t>(k) + 1];
        std::partial_sum(first_.begin(), first_.end(), first_.begin());
        position_.resize(static_cast<std::size_t>(n_));
        place_.resize(static_cast<std::size_t>(n_));
        colour_scale_.resize(n_);
        inverse_scale_.resize(n_);
        Index next = 0;
        for (std::size_t k = 0; k + 1 < first_.size(); ++k) {
            start_.push_back(next);
            for (Index i = first_[k]; i < first_[k + 1]; ++i, ++next) {
                const Index old = order_[static_cast<std::size_t>(i)];
                position_[static_cast<std::size_t>(old)] = next;
                place_[static_cast<std::size_t>(i)] = next + padding;
                colour_scale_[i] = scale_[old];
                inverse_scale_[i] = 1 / scale_[old];
            }
            next = (next + lanes - 1) / lanes * lanes;
        }
        padded_ = next;
    }

    /// In the scaled unknowns.
    void set_bounds(const ConstVectorRef& c) {
        lower_.setConstant(-infinity);
        if (!lower_only_) upper_.setConstant(infinity);
        const auto rows = unknown_.size();
        for (std::size_t i = 0; i < rows; ++i) {
            const Index at = unknown_[i] + padding;
            const double bound = bound_of(i, c);
            if (weight_[i] > 0)
                lower_[at] = std::max(lower_[at], bound);
            else
                upper_[at] = std::min(upper_[at], bound);
        }
    }

    double bound_of(std::size_t row, const ConstVectorRef& c) const {
        return c[static_cast<Index>(row)] / weight_[row] * unknown_scale_[row];
    }

    /// One pass over all colours; returns the largest change of an unknown.
    double sweep() {
        using Lanes = SlicedEll::Lanes;
        Lanes change = {};
        double* x = x_.data() + padding;
        for (std::size_t k = 0; k < sweep_.size(); ++k) {
            const SlicedEll& rows = sweep_[k];
            const Index slices = rows.slices();
            for (Index s = 0; s < slices; ++s) {
                Lanes sum;
                rows.multiply_slice(s, x, sum);
                const Index at = start_[k] + s * lanes;
                const Lanes old = SlicedEll::load(x + at);
                const Lanes lower = SlicedEll::load(lower_.data() + padding + at);
                Lanes next = old + omega_ * (SlicedEll::load(b_.data() + padding + at) - sum - old);
                next = next > lower ? next : lower;
                if (!lower_only_) {
                    const Lanes upper = SlicedEll::load(upper_.data() + padding + at);
                    next = next < upper ? next : upper;
                }
                SlicedEll::store(x + at, next);
                const Lanes up = next - old, down = old - next;
                const Lanes step = up > down ? up : down;
                change = step > change ? step : change;
            }
        }
        double largest = 0;
        for (int l = 0; l < lanes; ++l) largest = std::max(largest, change[l]);
        return largest;
    }

    /// lambda_i = (A u - b) at the unknown, over the weight, where the bound of row i is the one it lies on.
    void multipliers(const ConstVectorRef& c) {
        lambda_.setZero();
        if (shared_) taken_.assign(static_cast<std::size_t>(padded_), 0);
        const double* x = x_.data() + padding;
        for (std::size_t i = 0; i < unknown_.size(); ++i) {
            const Index at = unknown_[i];
            if (x[at] != bound_of(i, c) || (shared_ && taken_[static_cast<std::size_t>(at)])) continue;
            const auto k =
                static_cast<std::size_t>(std::upper_bound(start_.begin(), start_.end(), at) - start_.begin()) - 1;
            const Index row = at - start_[k];
            SlicedEll::Lanes sum;
            sweep_[k].multiply_slice(row / lanes, x, sum);
            const double force = (sum[row % lanes] + x[at] - b_[at + padding]) * unknown_scale_[i] / weight_[i];
            if (force > 0) {
                if (shared_) taken_[static_cast<std::size_t>(at)] = 1;
                lambda_[static_cast<Index>(i)] = force;
            }
        }
    }

    KktCertificate certificate_;
    Index n_, padded_ = 0;
    Vector scale_, colour_scale_, inverse_scale_;
    std::vector<Index> order_, position_, place_, first_, start_;
    std::vector<SlicedEll> sweep_;
    std::vector<Index> unknown_;
    std::vector<double> weight_, unknown_scale_;
    bool lower_only_ = true;
    bool shared_ = false;  // several rows on one unknown: the force goes to one of them
    std::vector<char> taken_;
    double omega_ = 1;
    Vector x_, b_, lower_, upper_, u_, lambda_;
};

}  // namespace

std::unique_ptr<PreparedContact> ColourSor::prepare(const Matrix& A, const Matrix& B) const {
    if (A.rows() != A.cols() || B.cols() != A.rows() || !A.is_symmetric())
        throw InputError("ColourSor: A is " + A.shape() + " and B is " + B.shape() +
                         ", expected a square symmetric A and as many columns in B");
    if (!(A.main_diagonal().array() > 0).all())
        throw InputError("ColourSor: A has a diagonal entry <= 0, expected positive definite");
    if (!ConstraintRows(B).bounds())
        throw InputError("ColourSor: B is " + B.shape() + " with a row of no or several entries, expected one a row");
    return std::make_unique<PreparedSor>(A, B);
}

}  // namespace tact
